# SPDX-License-Identifier: Apache-2.0
# cmake -D BUILD_DIR=... -D PYTHON=... -P unpack_and_run.cmake     PYTHON: that of the built module; empty: none
# Makes the Debian packages of the build, unpacks them into an empty folder and runs the program from there on the
# examples that stand beside it. tools/try_package.sh does the same where nothing else is installed.
set(place ${BUILD_DIR}/package_test)
set(root ${place}/root)
file(REMOVE_RECURSE ${place})
file(MAKE_DIRECTORY ${root} ${place}/run)

function(run)
  execute_process(COMMAND ${ARGV} WORKING_DIRECTORY ${place}/run COMMAND_ERROR_IS_FATAL ANY OUTPUT_VARIABLE output)
  set(output "${output}" PARENT_SCOPE)
endfunction()

function(expect what text)
  if(NOT text MATCHES "${what}")
    message(SEND_ERROR "expected ${what} in:\n${text}")
  endif()
endfunction()

run(cpack -G DEB --config ${BUILD_DIR}/CPackConfig.cmake -B ${place})
file(GLOB packages ${place}/*.deb)
foreach(package IN LISTS packages)
  run(dpkg -x ${package} ${root})
endforeach()
file(GLOB program ${place}/palpate_*.deb)
file(GLOB library ${place}/libpalpate-dev_*.deb)

run(dpkg-deb --info ${program})
expect("Depends: [^\n]*libfmt" "${output}")
expect("Research software: not for clinical use" "${output}")
if(output MATCHES "Depends: [^\n]*libopenmpi")
  message(SEND_ERROR "the program's package wants MPI:\n${output}")
endif()
run(dpkg-deb --info ${library})
expect("Depends: libeigen3-dev, libfmt-dev" "${output}")

foreach(file IN ITEMS bin/palpate share/man/man1/palpate.1.gz share/man/man1/palpate-identify-noise.1.gz
        share/bash-completion/completions/palpate share/zsh/vendor-completions/_palpate
        share/fish/vendor_completions.d/palpate.fish share/doc/palpate/copyright share/doc/libpalpate-dev/copyright
        lib/cmake/palpate/palpateConfig.cmake include/palpate/observer/force_observer.hpp lib/libpalpate.a)
  if(NOT EXISTS ${root}/usr/${file})
    message(SEND_ERROR "no package holds /usr/${file}")
  endif()
endforeach()

set(palpate ${root}/usr/bin/palpate)
set(example ${root}/usr/share/doc/palpate/examples/scenarios/beating_heart.toml)
run(${palpate} --help)
expect("estimate" "${output}")
run(${palpate} simulate ${example} --out run --duration 5)
run(${palpate} estimate --catheter run.catheter.toml run.tracker.csv --out run.estimate.csv)
run(${palpate} evaluate --estimate run.estimate.csv --truth run.force.csv --json)
foreach(axis IN ITEMS x y z)
  string(JSON inside GET "${output}" share_inside_3_sigma ${axis})
  if(inside LESS 0.95)
    message(SEND_ERROR "the truth lies inside 3 sigma in a share of ${inside} of the frames:\n${output}")
  endif()
endforeach()

if(NOT PYTHON)
  return()
endif()
file(GLOB module ${place}/python3-palpate_*.deb)
run(dpkg-deb --info ${module})
expect("Depends: [^\n]*python3-numpy" "${output}")
set(ENV{PYTHONPATH} ${root}/usr/lib/python3/dist-packages)
set(ENV{MPLBACKEND} Agg)
run(${PYTHON} -B -c "print(__import__('palpate').__file__)")
expect("${root}/usr/lib/python3/dist-packages/palpate/__init__.py" "${output}")
run(${PYTHON} -B ${root}/usr/share/doc/python3-palpate/python/examples/force_plot.py)
expect("written: force.png" "${output}")
