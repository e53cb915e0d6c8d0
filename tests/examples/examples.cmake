# SPDX-License-Identifier: Apache-2.0
# The numbered examples, with data that the project makes itself; each ends within two seconds.
set(demo ${PROJECT_BINARY_DIR}/artifacts/examples)
add_test(NAME example.demo_recording COMMAND make_demo_recording ${demo} 10)
set_tests_properties(example.demo_recording PROPERTIES FIXTURES_SETUP example_recording)
set(demo ${demo}/demo)

add_test(NAME example.01_shape COMMAND 01_shape)
add_test(NAME example.02_force_from_a_frame COMMAND 02_force_from_a_frame)
add_test(NAME example.03_recording COMMAND 03_recording ${demo}.catheter.toml ${demo}.tracker.csv ${demo}.force.csv)
add_test(NAME example.04_control_loop COMMAND 04_control_loop ${demo}.catheter.toml)
add_test(NAME example.05_batch COMMAND 05_batch)
add_test(NAME example.06_identify_stiffness COMMAND 06_identify_stiffness)
add_test(NAME example.07_simulate COMMAND 07_simulate ${PROJECT_SOURCE_DIR}/examples/scenarios/beating_heart.toml)
set(examples example.01_shape example.02_force_from_a_frame example.03_recording example.04_control_loop example.05_batch
             example.06_identify_stiffness example.07_simulate)
set_tests_properties(${examples} PROPERTIES LABELS example TIMEOUT 60)
set_tests_properties(example.03_recording example.04_control_loop PROPERTIES FIXTURES_REQUIRED example_recording)
