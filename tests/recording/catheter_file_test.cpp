// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <palpate/recording/catheter_file.hpp>
#include <tests/recording/temporary_folder.hpp>
#include <tests/shared_data.hpp>

namespace palpate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kPlain = R"(schema = 1
[catheter]
length_mm = 70.0
bending_stiffness_Nm2 = [0.2612e-3, 0.16664e-3]
torsional_stiffness_Nm2 = 0.1645e-3
precurvature_per_m = [39.99, 0.0, 0.0]
[base]
quaternion_wxyz = [1.0, 0.0, 0.0, 0.0]
position_mm = [10.0, 20.0, 30.0]
[[sensor]]
name = "tip"
arc_length_mm = 70.0
noise_mm = 0.28
)";

class CatheterFiles : public test::TemporaryFolder {
 protected:
  CatheterFile read(const std::string& text) const { return read_catheter_file(write("c.toml", text)); }

  /// The plain file with the first `from` replaced; `from` is written out so that line numbers can be counted.
  static std::string with(const std::string& from, const std::string& to) {
    std::string text = kPlain;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }

  std::string error(const std::string& from, const std::string& to) const {
    return error_of([&] { read(with(from, to)); });
  }
};

TEST_F(CatheterFiles, PlainFileInSiUnits) {
  const CatheterFile file = read(kPlain);
  const Catheter& catheter = file.catheter;
  ASSERT_EQ(catheter.rod.sections.size(), 1u);
  EXPECT_DOUBLE_EQ(catheter.rod.length_m(), 0.07);
  EXPECT_EQ(catheter.rod.sections[0].stiffness_Nm2, Stiffness(0.2612e-3, 0.16664e-3, 0.1645e-3));
  EXPECT_EQ(catheter.rod.sections[0].precurvature_per_m, Vector3d(39.99, 0, 0));
  EXPECT_TRUE(catheter.base.T_tracker_base.p.isApprox(Vector3d(0.01, 0.02, 0.03)));
  ASSERT_EQ(catheter.sensors.size(), 1u);
  EXPECT_EQ(catheter.sensors[0].name, "tip");
  EXPECT_DOUBLE_EQ(catheter.sensors[0].arc_length_m, 0.07);
  EXPECT_DOUBLE_EQ(catheter.sensors[0].noise_m.x(), 0.28e-3);
  EXPECT_DOUBLE_EQ(catheter.sensors[0].noise_rad, Sensor().noise_rad);
  EXPECT_FALSE(catheter.tendon.present);
  EXPECT_FALSE(file.reference.given);
  EXPECT_TRUE(file.warnings.empty());
}

TEST_F(CatheterFiles, TheContractsExampleIsRead) {
  PALPATE_NEEDS_SHARED("formats/catheter.toml");
  const CatheterFile file = read_catheter_file(test::shared_data("formats/catheter.toml"));
  EXPECT_EQ(file.catheter.name, "ThermoCool SF, 7F (paper, Table 2)");
  EXPECT_EQ(file.catheter.sensors.size(), 2u);
  EXPECT_DOUBLE_EQ(file.catheter.stiffness_sigma_fraction, 0.05);
  EXPECT_EQ(file.catheter.precurvature_sigma_per_m, Vector3d(0.5, 0.5, 0.2));
  EXPECT_TRUE(file.catheter.tendon.present);
  EXPECT_DOUBLE_EQ(file.catheter.base.position_sigma_m, 0.3e-3);
  EXPECT_DOUBLE_EQ(file.catheter.tendon.moment_sigma_fraction, 0.02);
  EXPECT_TRUE(file.warnings.empty());
}

TEST_F(CatheterFiles, EveryOptionalKeyOfTheShaft) {
  const CatheterFile file = read(with("torsional_stiffness_Nm2 = 0.1645e-3", R"(poisson_ratio = 0.3
shear_stiffness_N = 100
axial_stiffness_N = 200.0
weight_N_per_m = 2.0
rigid_tip_mm = 4.0)") + "[gravity]\ndirection_in_base = [0.0, 0.0, -3.0]\n");
  const Rod& rod = file.catheter.rod;
  EXPECT_DOUBLE_EQ(rod.sections[0].stiffness_Nm2.z(), (0.2612e-3 + 0.16664e-3) / 2.6);
  EXPECT_EQ(rod.shear_stiffness_N, 100.0);
  EXPECT_EQ(rod.axial_stiffness_N, 200.0);
  EXPECT_EQ(rod.distributed_load_base_N_per_m, Vector3d(0, 0, -2));
  EXPECT_DOUBLE_EQ(rod.rigid_tip_m, 0.004);
  EXPECT_TRUE(rod.contact_offset_m.isApprox(Vector3d(0, 0, 0.004)));
  const CatheterFile offset =
      read(with("length_mm = 70.0", "length_mm = 70\nrigid_tip_mm = 4\ncontact_offset_mm = [1, 0, 2]"));
  EXPECT_TRUE(offset.catheter.rod.contact_offset_m.isApprox(Vector3d(0.001, 0, 0.002)));
}

TEST_F(CatheterFiles, RoundShaft) {
  const CatheterFile file =
      read(with("bending_stiffness_Nm2 = [0.2612e-3, 0.16664e-3]\ntorsional_stiffness_Nm2 = 0.1645e-3",
                "youngs_modulus_Pa = 50e6\ndiameter_mm = 2.33\npoisson_ratio = 0.45"));
  EXPECT_EQ(file.catheter.rod.sections[0].stiffness_Nm2, round_shaft_stiffness(50e6, 2.33e-3, 0.45));
}

TEST_F(CatheterFiles, SectionsFillGapsAndFallBack) {
  const CatheterFile file = read(with("[base]", R"([[catheter.section]]
from_mm = 10.0
to_mm = 30.0
bending_stiffness_Nm2 = [1e-3, 2e-3]
[[catheter.section]]
from_mm = 30.0
to_mm = 40.0
rigid = true
precurvature_per_m = [0.0, 0.0, 0.0]
[base])"));
  const auto& sections = file.catheter.rod.sections;
  ASSERT_EQ(sections.size(), 4u);
  EXPECT_DOUBLE_EQ(sections[0].to_m, 0.01);
  EXPECT_EQ(sections[0].stiffness_Nm2.x(), 0.2612e-3);
  EXPECT_EQ(sections[1].stiffness_Nm2, Stiffness(1e-3, 2e-3, 0.1645e-3));
  EXPECT_EQ(sections[1].precurvature_per_m.x(), 39.99);
  EXPECT_TRUE(sections[2].rigid);
  EXPECT_EQ(sections[2].precurvature_per_m.x(), 0.0);
  EXPECT_DOUBLE_EQ(sections[3].from_m, 0.04);
  EXPECT_DOUBLE_EQ(sections[3].to_m, 0.07);
}

TEST_F(CatheterFiles, SensorKindsMountingAndMarkers) {
  const CatheterFile file = read(std::string(kPlain) + R"([[sensor]]
name = "shaft"
kind = "position"
arc_length_mm = 65.3
mount_quaternion_wxyz = [0.0, 1.0005, 0.0, 0.0]
mount_position_mm = [0.0, 1.0, 0.0]
noise_deg = 0.2
markers = ["tip2", "tip3"]
[[sensor]]
name = "five"
kind = "pose5"
arc_length_mm = 30
)");
  const Sensor& shaft = file.catheter.sensors[1];
  EXPECT_EQ(shaft.kind, SensorKind::kPosition);
  EXPECT_TRUE(shaft.T_local_sensor.R.isApprox(Matrix3d(Vector3d(1, -1, -1).asDiagonal()), 1e-12));
  EXPECT_TRUE(shaft.T_local_sensor.p.isApprox(Vector3d(0, 0.001, 0)));
  EXPECT_THAT(shaft.markers, ElementsAre("tip2", "tip3"));
  EXPECT_EQ(file.catheter.sensors[2].kind, SensorKind::kPose5);
}

TEST_F(CatheterFiles, BaseSensorByEntryOrByItsOwnKeys) {
  const std::string fixed = "quaternion_wxyz = [1.0, 0.0, 0.0, 0.0]\nposition_mm = [10.0, 20.0, 30.0]";
  const CatheterFile own = read(with(fixed, "sensor = \"clamp\"\nmount_position_mm = [1, 2, 3]\nnoise_mm = 0.1"));
  EXPECT_TRUE(own.catheter.base.tracked);
  EXPECT_EQ(own.catheter.base.sensor.name, "clamp");
  EXPECT_TRUE(own.catheter.base.sensor.T_local_sensor.p.isApprox(Vector3d(0.001, 0.002, 0.003)));
  const CatheterFile entry = read(with(fixed, "sensor = \"clamp\"") + "[[sensor]]\nname = \"clamp\"\nnoise_mm = 0.1\n");
  EXPECT_EQ(entry.catheter.sensors.size(), 1u);
  EXPECT_DOUBLE_EQ(entry.catheter.base.sensor.noise_m.z(), 1e-4);
  EXPECT_EQ(
      error_of([&] { read(with(fixed, "sensor = \"clamp\"\nnoise_mm = 0.2") + "[[sensor]]\nname = \"clamp\"\n"); }),
      "c.toml:9: base.noise_mm = 0.2: expected this key in the [[sensor]] entry 'clamp'");
  EXPECT_EQ(error("[base]", "[base]\nsensor = \"clamp\""),
            "c.toml:9: base.quaternion_wxyz = [1, 0, 0, 0]: expected either this, or sensor");
  EXPECT_EQ(error("[base]", "[base]\nnoise_mm = 0.2"),
            "c.toml:8: base.noise_mm = 0.2: expected this key only together with base.sensor");
}

TEST_F(CatheterFiles, RegistrationAndDelayOfASensor) {
  const std::string own = "noise_mm = 0.28\nbase_quaternion_wxyz = [0, 0, 1, 0]\nbase_position_mm = [1, 2, -3]\n";
  const auto file = read(with("noise_mm = 0.28\n", own + "delay_s = -0.25\n"));
  const Sensor& sensor = file.catheter.sensors[0];
  ASSERT_TRUE(sensor.T_tracker_base.has_value());
  EXPECT_TRUE(sensor.T_tracker_base->R.isApprox(Matrix3d(Vector3d(-1, 1, -1).asDiagonal())));
  EXPECT_TRUE(sensor.T_tracker_base->p.isApprox(Vector3d(0.001, 0.002, -0.003)));
  EXPECT_EQ(sensor.delay_s, -0.25);
  EXPECT_TRUE(file.warnings.empty());
  EXPECT_FALSE(read(kPlain).catheter.sensors[0].T_tracker_base.has_value());
  EXPECT_EQ(read(kPlain).catheter.sensors[0].delay_s, 0.0);

  EXPECT_EQ(error("noise_mm = 0.28\n", "base_position_mm = [1, 2, -3]\n"),
            "c.toml:10: sensor.base_quaternion_wxyz = (absent): expected base_quaternion_wxyz and base_position_mm, "
            "both, of the clamp in this sensor's own tracker");
  EXPECT_EQ(error("noise_mm = 0.28\n", "base_quaternion_wxyz = [1, 1, 0, 0]\nbase_position_mm = [1, 2, -3]\n"),
            "c.toml:13: sensor.base_quaternion_wxyz = [1, 1, 0, 0]: expected a unit quaternion [w, x, y, z], here of "
            "norm 1.41421");
  EXPECT_EQ(error("noise_mm = 0.28\n", "delay_s = \"40 ms\"\n"),
            "c.toml:13: sensor.delay_s = \"40 ms\": expected a time in seconds, as a number without quotes");
  const std::string tracked = "[base]\nsensor = \"clamp\"\n[[sensor]]\nname = \"clamp\"\n";
  const std::string fixed = "[base]\nquaternion_wxyz = [1.0, 0.0, 0.0, 0.0]\nposition_mm = [10.0, 20.0, 30.0]\n";
  EXPECT_EQ(error(fixed, tracked + "base_position_mm = [0, 0, 0]\n"),
            "c.toml:11: sensor.base_position_mm = [0, 0, 0]: expected no such key, for this is the base sensor");
  EXPECT_EQ(read(with(fixed, "[base]\nsensor = \"clamp\"\ndelay_s = 0.1\n")).catheter.base.sensor.delay_s, 0.1);
}

TEST_F(CatheterFiles, EstimatorReferenceRecordingAndTendon) {
  const CatheterFile file = read(std::string(kPlain) + R"([tendon]
model = "end_moment"
offset_mm = 0.9
[estimator]
method = "iaekf"
measurement = "tip_and_curvature"
state = ["force"]
force_model = "random_walk"
force_rate_N_per_sqrt_s = 0.5
initial_force_sigma_N = 1
max_iterations = 20
adaptation_window = 30
outlier_probability = 1e-4
[recording]
ignore_sensors = ["Reference"]
[reference]
from_s = 0
to_s = 0.19
shape = "straight"
)");
  EXPECT_EQ(file.catheter.tendon.model, TendonModel::kEndMoment);
  EXPECT_DOUBLE_EQ(file.catheter.tendon.offset_m, 0.9e-3);
  EXPECT_EQ(file.observer.method, Method::kIaekf);
  EXPECT_EQ(file.observer.measurement, MeasurementKind::kTipAndCurvature);
  EXPECT_EQ(file.observer.force_rate_N_per_sqrt_s, 0.5);
  EXPECT_EQ(file.observer.initial_force_sigma_N, 1.0);
  EXPECT_EQ(file.observer.max_iterations, 20);
  EXPECT_EQ(file.observer.adaptation_window, 30);
  EXPECT_EQ(file.observer.outlier_probability, 1e-4);
  EXPECT_THAT(file.ignore_sensors, ElementsAre("Reference"));
  EXPECT_TRUE(file.reference.given);
  EXPECT_TRUE(file.reference.straight);
  EXPECT_EQ(file.reference.to_s, 0.19);
  EXPECT_TRUE(file.warnings.empty());
}

TEST_F(CatheterFiles, WhatIsNotKnownExactly) {
  const CatheterFile plain = read(kPlain);
  EXPECT_EQ(plain.catheter.stiffness_correlation, 0.9);
  EXPECT_DOUBLE_EQ(plain.catheter.bias_length_m, 0.05);
  EXPECT_EQ(plain.catheter.bias_memory_s, 60.0);
  const CatheterFile file = read(with("length_mm = 70.0", R"(length_mm = 70
stiffness_sigma_percent = 5
stiffness_correlation = 0.5
precurvature_sigma_per_m = [0.5, 0.4, 0.2])") +
                                 R"(mount_sigma_mm = 0.1
bias_mm = 0.48
bias_deg = 0.3
[tracker]
bias_length_mm = 80
bias_memory_s = 1e9
[tendon]
moment_sigma_percent = 2
)");
  EXPECT_DOUBLE_EQ(file.catheter.stiffness_sigma_fraction, 0.05);
  EXPECT_EQ(file.catheter.stiffness_correlation, 0.5);
  EXPECT_EQ(file.catheter.precurvature_sigma_per_m, Vector3d(0.5, 0.4, 0.2));
  EXPECT_DOUBLE_EQ(file.catheter.sensors[0].mount_sigma_m, 1e-4);
  EXPECT_DOUBLE_EQ(file.catheter.sensors[0].bias_m, 0.48e-3);
  EXPECT_DOUBLE_EQ(file.catheter.bias_length_m, 0.08);
  EXPECT_EQ(file.catheter.bias_memory_s, 1e9);
  EXPECT_TRUE(file.warnings.empty()) << "all of this widens the force's sigma";

  EXPECT_EQ(error("70.0", "70.0\nstiffness_correlation = 1.0"),
            "c.toml:4: catheter.stiffness_correlation = 1: expected a correlation, 0..0.999");
  const auto tracker_error = [&](const std::string& key) {
    return error_of([&] { read(std::string(kPlain) + "[tracker]\n" + key + "\n"); });
  };
  EXPECT_EQ(tracker_error("bias_length_mm = 0"),
            "c.toml:15: tracker.bias_length_mm = 0: expected a length in mm, more than 0, at most 1e6");
  EXPECT_EQ(tracker_error("bias_memory_s = 2e9"),
            "c.toml:15: tracker.bias_memory_s = 2000000000: expected seconds, more than 0, at most 1e9");
  EXPECT_EQ(tracker_error("bias_memory_s = \"1 min\""),
            "c.toml:15: tracker.bias_memory_s = \"1 min\": expected seconds, more than 0, at most 1e9, as a number "
            "without quotes");
  EXPECT_EQ(tracker_error("bias_lenght_mm = 50"),
            "c.toml:15: tracker.bias_lenght_mm = 50: expected a known key; did you mean bias_length_mm?");
}

TEST_F(CatheterFiles, EstimatedParameters) {
  const ObserverOptions defaults;
  const CatheterFile plain = read(std::string(kPlain) + "[estimator]\n");
  EXPECT_FALSE(plain.observer.estimate_stiffness || plain.observer.estimate_precurvature);
  EXPECT_FALSE(plain.observer.free_torsion);
  EXPECT_TRUE(plain.observer.consider_uncertainty);
  EXPECT_EQ(plain.observer.stiffness_drift_per_sqrt_s, defaults.stiffness_drift_per_sqrt_s);
  EXPECT_EQ(plain.observer.precurvature_drift_per_m_sqrt_s, defaults.precurvature_drift_per_m_sqrt_s);
  const CatheterFile file = read(std::string(kPlain) + R"([estimator]
state = ["precurvature", "stiffness", "force"]
torsion = "free"
consider = false
stiffness_drift_percent_per_sqrt_s = 2.0
precurvature_drift_per_m_sqrt_s = 0.3
)");
  EXPECT_TRUE(file.observer.estimate_stiffness);
  EXPECT_TRUE(file.observer.estimate_precurvature);
  EXPECT_TRUE(file.observer.free_torsion);
  EXPECT_FALSE(file.observer.consider_uncertainty);
  EXPECT_DOUBLE_EQ(file.observer.stiffness_drift_per_sqrt_s, 0.02);
  EXPECT_EQ(file.observer.precurvature_drift_per_m_sqrt_s, 0.3);
  EXPECT_TRUE(file.warnings.empty());

  const auto estimator_error = [&](const std::string& key) {
    return error_of([&] { read(std::string(kPlain) + "[estimator]\n" + key + "\n"); });
  };
  EXPECT_EQ(estimator_error("state = [\"stiffness\"]"),
            "c.toml:15: estimator.state = [\"stiffness\"]: expected \"force\", to which \"stiffness\", "
            "\"precurvature\" may be added");
  EXPECT_EQ(estimator_error("torsion = \"loose\""),
            "c.toml:15: estimator.torsion = \"loose\": expected one of 'tied', 'free'");
  EXPECT_EQ(estimator_error("consider = \"no\""), "c.toml:15: estimator.consider = \"no\": expected true or false");
  EXPECT_EQ(
      estimator_error("stiffness_drift_percent_per_sqrt_s = 0"),
      "c.toml:15: estimator.stiffness_drift_percent_per_sqrt_s = 0: expected %/sqrt(s), more than 0, at most 1000");
  EXPECT_EQ(estimator_error("precurvature_drift_per_m_sqrt_s = 1001"),
            "c.toml:15: estimator.precurvature_drift_per_m_sqrt_s = 1001: expected 1/(m sqrt(s)), more than 0, at most "
            "1000");
}

TEST_F(CatheterFiles, UnknownKeysSuggestTheNearest) {
  EXPECT_EQ(error("length_mm", "lenght_mm"),
            "c.toml:3: catheter.lenght_mm = 70: expected a known key; did you mean length_mm?");
  EXPECT_EQ(error("noise_mm", "noise_m"),
            "c.toml:13: sensor.noise_m = 0.28: expected a known key; did you mean noise_mm?");
  EXPECT_EQ(error("position_mm = [", "positon_mm = ["),
            "c.toml:9: base.positon_mm = [10, 20, 30]: expected a known key; did you mean position_mm?");
  EXPECT_THAT(error("[[sensor]]", "[[sensors]]"), HasSubstr("expected a known key; did you mean sensor?"));
  EXPECT_THAT(error_of([&] { read(std::string(kPlain) + "[estimator]\nmetod = \"iekf\"\n"); }),
              HasSubstr("c.toml:15: estimator.metod = \"iekf\": expected a known key; did you mean method?"));
  EXPECT_THAT(error("[base]", "[[catheter.section]]\nfrom = 0\n[base]"), HasSubstr("did you mean from_mm?"));
}

TEST_F(CatheterFiles, MissingKeys) {
  EXPECT_EQ(error("length_mm = 70.0\n", ""),
            "c.toml:2: catheter.length_mm = (absent): expected a length in mm, 1..5000 (is it in metres?)");
  EXPECT_EQ(error("torsional_stiffness_Nm2 = 0.1645e-3\n", ""),
            "c.toml:2: catheter.torsional_stiffness_Nm2 = (absent): expected GJ in N m^2, or poisson_ratio");
  EXPECT_EQ(error("bending_stiffness_Nm2 = [0.2612e-3, 0.16664e-3]\n", ""),
            "c.toml:2: catheter.bending_stiffness_Nm2 = (absent): expected [EI1, EI2] in N m^2, or youngs_modulus_Pa, "
            "diameter_mm and poisson_ratio");
  EXPECT_EQ(error("name = \"tip\"\n", ""), "c.toml:10: sensor.name = (absent): expected a text in quotes, not empty");
  EXPECT_EQ(error("arc_length_mm = 70.0\n", ""), "c.toml:10: sensor.arc_length_mm = (absent): expected a number in mm");
  EXPECT_EQ(error("position_mm = [10.0, 20.0, 30.0]\n", ""),
            "c.toml:7: base.position_mm = (absent): expected quaternion_wxyz and position_mm of the clamp in the "
            "tracker, or sensor");
  EXPECT_THAT(error_of([&] { read("schema = 1\n"); }), HasSubstr("catheter = (absent): expected a table [catheter]"));
}

TEST_F(CatheterFiles, MistypedValues) {
  EXPECT_EQ(
      error("70.0", "\"70 mm\""),
      "c.toml:3: catheter.length_mm = \"70 mm\": expected a length in mm, 1..5000 (is it in metres?), as a number "
      "without quotes");
  EXPECT_EQ(
      error("[39.99, 0.0, 0.0]", "39.99"),
      "c.toml:6: catheter.precurvature_per_m = 39.99: expected [3 numbers], each a curvature in 1/m, at most 1000");
  EXPECT_EQ(error("\"tip\"", "7"), "c.toml:11: sensor.name = 7: expected a text in quotes, not empty");
  EXPECT_EQ(error("name = \"tip\"", "name = \"tip\"\nkind = \"6dof\""),
            "c.toml:12: sensor.kind = \"6dof\": expected one of 'pose', 'pose5', 'position'");
  EXPECT_EQ(error("name = \"tip\"", "name = \"tip\"\nmarkers = \"a\""),
            "c.toml:12: sensor.markers = \"a\": expected an array of texts, such as [\"a\", \"b\"]");
  EXPECT_EQ(error("schema = 1", "schema = 2"), "c.toml:1: schema = 2: expected 1, the schema this program reads");
  EXPECT_EQ(error("schema = 1", "estimator = 1"), "c.toml:1: estimator = 1: expected a table [estimator]");
  EXPECT_EQ(error_of([&] { read(std::string(kPlain) + "[estimator]\nmax_iterations = 2.5\n"); }),
            "c.toml:15: estimator.max_iterations = 2.5: expected an integer, 1..100");
  for (const char* header : {"[", "[[", "[ # base", "[]", "[=]"}) {
    EXPECT_THAT(error("[base]", header),
                HasSubstr("c.toml:7: line '" + std::string(header) + "': expected TOML: [NAME]"));
  }
  EXPECT_THAT(error("length_mm = 70.0", "length_mm = = 70"),
              HasSubstr("c.toml:3: line 'length_mm = = 70': expected TOML: "));
}

TEST_F(CatheterFiles, ValuesOutOfRangeOrInTheWrongUnit) {
  EXPECT_EQ(error("70.0", "0.07"),
            "c.toml:3: catheter.length_mm = 0.07: expected a length in mm, 1..5000 (is it in metres?)");
  EXPECT_EQ(error("70.0", "nan"),
            "c.toml:3: catheter.length_mm = nan: expected a length in mm, 1..5000 (is it in metres?)");
  EXPECT_EQ(
      error("[0.2612e-3, 0.16664e-3]", "[261.2, 166.64]"),
      "c.toml:4: catheter.bending_stiffness_Nm2 = [261.2, 166.64]: expected a stiffness in N m^2 with stiffness / "
      "length^2 in 1e-5..1e4 N, here 5.33e+04 N (is it in N mm^2?)");
  EXPECT_EQ(error("[0.2612e-3, 0.16664e-3]", "[-0.2612e-3, 0.16664e-3]"),
            "c.toml:4: catheter.bending_stiffness_Nm2 = [-0.0002612, 0.00016664]: expected [2 numbers], each a number "
            "more than 0");
  EXPECT_EQ(error("39.99", "39990"),
            "c.toml:6: catheter.precurvature_per_m = [39990, 0, 0]: expected [3 numbers], each a curvature in 1/m, "
            "at most 1000");
  EXPECT_EQ(error("arc_length_mm = 70.0", "arc_length_mm = 75.0"),
            "c.toml:12: sensor.arc_length_mm = 75: expected 0..70 mm, the shaft with its rigid tip");
  EXPECT_EQ(error("arc_length_mm = 70.0", "arc_length_mm = 0.07"),
            "c.toml:12: sensor.arc_length_mm = 0.07: expected millimetres along a shaft of 70 mm (is it in metres?)");
  EXPECT_EQ(error("0.28", "280"),
            "c.toml:13: sensor.noise_mm = 280: expected a standard deviation in mm, more than 0, at most 50 (is it in "
            "um?)");
  EXPECT_EQ(error("[1.0, 0.0, 0.0, 0.0]", "[1.0, 0.1, 0.0, 0.0]"),
            "c.toml:8: base.quaternion_wxyz = [1, 0.1, 0, 0]: expected a unit quaternion [w, x, y, z], here of "
            "norm 1.00499");
  EXPECT_EQ(
      error("70.0", "70.0\nshear_stiffness_N = 10.0"),
      "c.toml:4: catheter.shear_stiffness_N = 10: expected shear_stiffness_N and axial_stiffness_N both more than "
      "0, or both 0 or absent");
  EXPECT_EQ(error("70.0", "70.0\npoisson_ratio = 0.3"),
            "c.toml:4: catheter.poisson_ratio = 0.3: expected either this or torsional_stiffness_Nm2, not both");
  EXPECT_THAT(error("70.0", "70.0\nyoungs_modulus_Pa = 50e6"), HasSubstr("expected either this, or youngs_modulus_Pa"));
  EXPECT_THAT(error("70.0", "70.0\nweight_N_per_m = 2.0"), HasSubstr("expected [gravity] direction_in_base"));
}

TEST_F(CatheterFiles, SensorsThatDoNotFit) {
  const std::string again = "[[sensor]]\nname = \"tip\"\narc_length_mm = 10\n";
  EXPECT_EQ(error_of([&] { read(kPlain + again); }), "c.toml:15: sensor.name = \"tip\": expected each name once");
  std::string many = kPlain;
  for (int i = 0; i < kMaxSensors; ++i) {
    many += "[[sensor]]\nname = \"s" + std::to_string(i) + "\"\narc_length_mm = 10\n";
  }
  EXPECT_THAT(error_of([&] { read(many); }),
              HasSubstr("sensor.name = \"s7\": expected at most 8 sensors on the shaft"));
}

TEST_F(CatheterFiles, SectionsThatDoNotTile) {
  const auto sections = [](const char* second) {
    return std::string("[[catheter.section]]\nfrom_mm = 0\nto_mm = 30\n[[catheter.section]]\n") + second + "\n[base]";
  };
  EXPECT_EQ(error("[base]", sections("from_mm = 20\nto_mm = 70")),
            "c.toml:11: catheter.section.from_mm = 20: expected 30 or more, where the section before ends (in mm)");
  EXPECT_EQ(error("[base]", sections("from_mm = 30\nto_mm = 80")),
            "c.toml:12: catheter.section.to_mm = 80: expected more than from_mm, at most length_mm = 70");
  EXPECT_EQ(error("[base]", sections("from_mm = 30\nto_mm = 30")),
            "c.toml:12: catheter.section.to_mm = 30: expected more than from_mm, at most length_mm = 70");
}

TEST_F(CatheterFiles, ReferenceMustBeAnInterval) {
  EXPECT_EQ(error_of([&] { read(std::string(kPlain) + "[reference]\nfrom_s = 2\nto_s = 1\n"); }),
            "c.toml:16: reference.to_s = 1: expected a time later than from_s");
}

}  // namespace
}  // namespace palpate
