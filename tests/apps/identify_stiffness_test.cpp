// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/recording/catheter_file.hpp>
#include <palpate/rod/base_loads.hpp>
#include <tests/apps/app_fixture.hpp>

namespace palpate {
namespace {

struct Load {
  const char* name;
  Vector3d force_base_N;
};

/// Across both axes, and twisting: the shaft is bent, so a load across its plane turns it.
const std::vector<Load> kLoads = {{"up", {0.0, 0.02, 0.0}},
                                  {"down", {0.0, -0.02, 0.0}},
                                  {"left", {0.02, 0.0, 0.0}},
                                  {"diagonal", {-0.015, 0.01, 0.0}}};

/// Points of a virtual shaft under dead loads, 1 cm apart. The oracle is the stiffness that made them.
class IdentifyStiffness : public test::App {
 protected:
  void SetUp() override {
    App::SetUp();
    write_cases(kLoads);
    write_points(true_rod(1.2, 0.9), kLoads);
  }

  /// The catheter file's shaft with other bending stiffness; GJ keeps its share of EI1 + EI2.
  Rod true_rod(double factor_1, double factor_2) const {
    Rod rod = read_catheter_file(path("c.toml")).catheter.rod;
    for (Section& section : rod.sections) {
      Stiffness& K = section.stiffness_Nm2;
      const double sum_Nm2 = K.x() + K.y();
      K.x() *= factor_1;
      K.y() *= factor_2;
      K.z() *= (K.x() + K.y()) / sum_Nm2;
    }
    return rod;
  }

  void write_points(const Rod& rod, const std::vector<Load>& loads) const {
    const std::vector<double> stations_m = {0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07};
    const RodSolver solver(rod, stations_m);
    std::string text = "case,arc_length_mm,x_mm,y_mm,z_mm\n";
    for (const Load& load : loads) {
      RodSolution<0> solution = solver.make_solution<0>();
      solver.solve(follow_from_rest(solver, {.force_base_N = load.force_base_N, .tip = {}}).load, solution);
      for (std::size_t i = 0; i < stations_m.size(); ++i) {
        const Vector3d mm = 1e3 * solution.points[i].T_base_local.p;
        text += fmt::format("{},{},{:.6f},{:.6f},{:.6f}\n", load.name, 1e3 * stations_m[i], mm.x(), mm.y(), mm.z());
      }
    }
    write("points.csv", text);
  }

  void write_cases(const std::vector<Load>& loads, const std::string& head = "") const {
    std::string text = head;
    for (const Load& load : loads)
      text += fmt::format("[[case]]\nname = \"{}\"\nforce_base_N = [{:.4f}, {:.4f}, {:.4f}]\npoints = \"points.csv\"\n",
                          load.name, load.force_base_N.x(), load.force_base_N.y(), load.force_base_N.z());
    write("cases.toml", text);
  }

  Arguments with(const Arguments& more) const {
    Arguments arguments{"identify", "stiffness", "--catheter", "c.toml", "--cases", "cases.toml", "--out", "new.toml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  nlohmann::json identified(Arguments more = {}) const {
    more.push_back("--json");
    const test::ProgramRun run = palpate(with(more));
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.err, "");
    return nlohmann::json::parse(run.out, nullptr, false);
  }
  Stiffness written() const { return read_catheter_file(path("new.toml")).catheter.rod.sections[0].stiffness_Nm2; }
};

TEST_F(IdentifyStiffness, FindsWhatMadeThePoints) {
  const nlohmann::json json = identified();
  const Stiffness truth = true_rod(1.2, 0.9).sections[0].stiffness_Nm2;
  ASSERT_EQ(json["unknowns"].size(), 2u);
  EXPECT_NEAR(json["unknowns"][0]["value"].get<double>() / truth.x(), 1.0, 1e-4);
  EXPECT_NEAR(json["unknowns"][1]["value"].get<double>() / truth.y(), 1.0, 1e-4);
  EXPECT_LT(json["rms_mm"].get<double>(), 1e-5);
  EXPECT_LT((written().cwiseQuotient(truth) - Vector3d::Ones()).cwiseAbs().maxCoeff(), 1e-4);
  ASSERT_EQ(json["left_out"].size(), 4u);
  for (const auto& one : json["left_out"]) EXPECT_NEAR(one["difference_percent"].get<double>(), 0.0, 0.01) << one;
}

TEST_F(IdentifyStiffness, BothMethodsAgree) {
  const double lm = identified()["unknowns"][0]["value"],
               simplex = identified({"--method", "nelder-mead"})["unknowns"][0]["value"];
  EXPECT_NEAR(lm / simplex, 1.0, 1e-4);
}

TEST_F(IdentifyStiffness, WritesACatheterFileThatEstimateTakes) {
  write("c.toml", "# of last spring\n" + contents(path("c.toml")));
  const test::ProgramRun run = palpate(with({}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("each case left out"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("EI2"), std::string::npos) << run.out;
  const std::string text = contents(path("new.toml"));
  EXPECT_TRUE(text.starts_with("# of last spring\n")) << text;
  EXPECT_NE(text.find("precurvature_per_m = [24.57, 0.0, 0.0]"), std::string::npos) << text;
  EXPECT_NE(text.find("# identified: +- "), std::string::npos) << text;
  const Catheter after = read_catheter_file(path("new.toml")).catheter;
  EXPECT_GT(after.stiffness_sigma_fraction, 0.0);
  EXPECT_LT(after.stiffness_sigma_fraction, 1e-3);
  EXPECT_EQ(palpate({"estimate", "--catheter", "new.toml", "r.csv", "--out", "e.csv"}).exit_code, 0);
}

TEST_F(IdentifyStiffness, SigmaOfThreeIsThatOfTheWorst) {
  write_cases({kLoads[0], kLoads[2]});
  const nlohmann::json json = identified();
  double worst = 0.0;
  for (const auto& unknown : json["unknowns"]) worst = std::max(worst, unknown["sigma_percent"].get<double>());
  EXPECT_GE(json["stiffness_sigma_percent"].get<double>(), worst * (1.0 - 1e-9));
}

TEST_F(IdentifyStiffness, ModulusGivesWayToStiffness) {
  const std::string stiffness =
      "bending_stiffness_Nm2 = [0.2612e-3, 0.16664e-3]\ntorsional_stiffness_Nm2 = 0.1645e-3\n";
  write_catheter(stiffness, "youngs_modulus_Pa = 1.0e8\ndiameter_mm = 2.5\npoisson_ratio = 0.3\n");
  write_points(true_rod(1.1, 1.1), kLoads);
  identified({"--unknowns", "scale"});
  const Stiffness truth = true_rod(1.1, 1.1).sections[0].stiffness_Nm2;
  EXPECT_LT((written().cwiseQuotient(truth) - Vector3d::Ones()).cwiseAbs().maxCoeff(), 1e-4);
  for (const char* key : {"youngs_modulus_Pa", "diameter_mm", "poisson_ratio"})
    EXPECT_EQ(contents(path("new.toml")).find(key), std::string::npos) << key;
}

TEST_F(IdentifyStiffness, SectionsAreScaledAlike) {
  const std::string section =
      "[[catheter.section]]\nfrom_mm = 0.0\nto_mm = 40.0\nbending_stiffness_Nm2 = [0.6e-3, 0.5e-3]  # braided\n"
      "torsional_stiffness_Nm2 = 0.4e-3\n[[catheter.section]]\nfrom_mm = 65.0\nto_mm = 70.0\nrigid = true\n[base]";
  write_catheter("[base]", section);
  write_points(true_rod(1.3, 1.3), kLoads);
  identified({"--unknowns", "scale"});
  const auto truth = true_rod(1.3, 1.3).sections, found = read_catheter_file(path("new.toml")).catheter.rod.sections;
  ASSERT_EQ(found.size(), 3u);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_LT((found[i].stiffness_Nm2.cwiseQuotient(truth[i].stiffness_Nm2) - Vector3d::Ones()).cwiseAbs().maxCoeff(),
              1e-4)
        << i;
  EXPECT_TRUE(found[2].rigid);
}

TEST_F(IdentifyStiffness, DrawsAPicture) {
  identified({"--plot", "p.svg"});
  const std::string picture = contents(path("p.svg"));
  EXPECT_NE(picture.find("diagonal"), std::string::npos);
  EXPECT_NE(picture.find("measured - fitted"), std::string::npos);
}

TEST_F(IdentifyStiffness, HelpHasAnExample) {
  const test::ProgramRun run = palpate({"identify", "stiffness", "--help"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_NE(run.out.find("Example: palpate identify stiffness"), std::string::npos);
}

/// What a user reads when loads, points or flags are wrong; nothing is written.
class BadLoadCases : public IdentifyStiffness {
 protected:
  std::string refusal_with(const Arguments& more = {}) const { return refusal(with(more)); }
  std::string warnings_with(const Arguments& more = {}) const {
    const test::ProgramRun run = palpate(with(more));
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.err;
  }
};

TEST_F(BadLoadCases, LoadsThatBendOneAxis) {
  write_catheter("precurvature_per_m = [24.57, 0.0, 0.0]", "");
  const std::vector<Load> loads = {kLoads[0], kLoads[1]};
  write_cases(loads);
  write_points(true_rod(1.0, 1.0), loads);
  EXPECT_NE(warnings_with().find("palpate: warning: EI2 is not told: all loads bend the shaft about d1"),
            std::string::npos)
      << warnings_with();
  EXPECT_EQ(read_catheter_file(path("new.toml")).catheter.stiffness_sigma_fraction, 1.0);
  EXPECT_EQ(warnings_with({"--unknowns", "scale"}), "");
}

TEST_F(BadLoadCases, FewerLoadsThanUnknowns) {
  write_cases({kLoads[3]});
  EXPECT_NE(warnings_with().find("cases.toml: 1 case with a load for 2 unknowns"), std::string::npos);
  write("points.csv", "case,arc_length_mm,x_mm\ndiagonal,70,-30\n");
  EXPECT_NE(refusal_with().find("1 measured components for 2 unknown stiffnesses"), std::string::npos);
}

TEST_F(BadLoadCases, NoLoadAtAll) {
  write_cases({{"up", Vector3d::Zero()}});
  EXPECT_NE(refusal_with().find("no load case has a load"), std::string::npos) << refusal_with();
}

TEST_F(BadLoadCases, CollinearPoints) {
  write_catheter("precurvature_per_m = [24.57, 0.0, 0.0]", "");
  write_cases({kLoads[0]});
  write("points.csv", "case,arc_length_mm,x_mm,y_mm,z_mm\nup,30,0,0,30\nup,50,0,0,50\nup,70,0,0,70\n");
  const std::string straight = refusal_with({"--unknowns", "scale"});
  EXPECT_NE(straight.find("are the points bent"), std::string::npos) << straight;
  write("points.csv", "case,arc_length_mm,x_mm,y_mm,z_mm\nup,30,0,2,29.9\nup,50,0,4,49.8\nup,70,0,6,69.7\n");
  EXPECT_NE(warnings_with({"--unknowns", "scale"}).find("its 3 points lie on a straight line"), std::string::npos);
}

TEST_F(BadLoadCases, LengthsOfSeventyMetres) {
  write_catheter("length_mm = 70.0", "length_mm = 70000.0");
  EXPECT_EQ(refusal_with(),
            "c.toml:4: catheter.length_mm = 70000: expected a length in mm, 1..5000 (is it in metres?)");
  write_catheter("length_mm = 70.0", "length_mm = 70.0");
  write("points.csv", "case,arc_length_mm,x_mm,y_mm,z_mm\nup,70,0,2,70000\n");
  EXPECT_EQ(refusal_with(),
            "points.csv:2: field z_mm: value '70000': expected millimetres, a point at most 125 mm from the clamp of a "
            "shaft of 70 mm");
}

TEST_F(BadLoadCases, BrokenFiles) {
  std::string points = contents(path("points.csv"));
  write("points.csv", points.replace(points.find("up,20"), 5, "up,2o"));
  EXPECT_EQ(refusal_with(), "points.csv:3: field arc_length_mm: value '2o': expected a number");
  std::filesystem::remove(path("points.csv"));
  EXPECT_EQ(refusal_with(), "points.csv: cannot be opened: No such file or directory: expected a readable text file");
  write_cases(kLoads, "own_weigth = \"included\"\n");
  EXPECT_EQ(refusal_with(), "cases.toml:1: own_weigth = \"included\": expected a known key; did you mean own_weight?");
}

TEST_F(BadLoadCases, BadFlags) {
  EXPECT_EQ(refusal_with({"--unknowns", "all"}), "--unknowns all: expected bending or scale or bending,torsion");
  EXPECT_EQ(refusal_with({"--method", "simplex"}), "--method simplex: expected lm or nelder-mead");
  EXPECT_EQ(refusal_with({"--poisson", "0.3", "--unknowns", "scale"}),
            "--poisson 0.3: expected with --unknowns bending, where it ties GJ to EI1 and EI2");
  EXPECT_EQ(refusal_with({"--free-shear"}),
            "--free-shear: expected shear_stiffness_N and axial_stiffness_N in c.toml to start from");
  EXPECT_EQ(refusal_with({"--plot", "p.pdf"}), "--plot p.pdf: expected a file name that ends in .svg or .png");
  EXPECT_EQ(refusal({"identify", "stiffness", "--catheter", "c.toml", "--cases", "cases.toml", "--out", "./c.toml"}),
            "--out ./c.toml: expected another file than the catheter file");
}

TEST_F(BadLoadCases, MeasurementsAreNeverOverwritten) {
  for (const char* flag : {"--out", "--plot"}) {
    write("points.svg", contents(path("points.csv")));
    write("cases.toml", std::string("[[case]]\nname = \"up\"\nforce_base_N = [0, 0.02, 0]\npoints = \"points.") +
                            (flag[2] == 'o' ? "csv" : "svg") + "\"\n");
    const std::string file = flag[2] == 'o' ? "points.csv" : "points.svg";
    EXPECT_EQ(refusal({"identify", "stiffness", "--catheter", "c.toml", "--cases", "cases.toml", "--out",
                       flag[2] == 'o' ? file : "new.toml", "--plot", flag[2] == 'o' ? "p.svg" : file}),
              std::string(flag) + " " + file + ": expected another file than " + file);
  }
}

TEST_F(BadLoadCases, NoPictureStaysWhereTheCatheterFileCannotBeWritten) {
  std::filesystem::create_directory(path("folder.toml"));
  const test::ProgramRun run = palpate({"identify", "stiffness", "--catheter", "c.toml", "--cases", "cases.toml",
                                        "--out", "folder.toml", "--plot", "p.svg"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(path("p.svg")));
}

TEST_F(BadLoadCases, PlacesInMetres) {
  std::string text = "case,arc_length_mm,x_mm,y_mm,z_mm\n";
  for (const Load& load : kLoads)
    for (int i = 1; i <= 7; ++i) text += fmt::format("{},{},{},0,{}\n", load.name, 10 * i, 1e-4 * i * i, 0.0098 * i);
  write("points.csv", text);
  EXPECT_NE(refusal_with().find("(are the positions in metres?)"), std::string::npos) << refusal_with();
}

}  // namespace
}  // namespace palpate
