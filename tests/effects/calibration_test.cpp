#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <string>

#include "effect_scenes.h"
#include "occlod/auto_refiner.h"
#include "occlod/base.h"
#include "occlod/visibility.h"
#include "papers/trial_devices.h"

namespace occlod::test {
namespace {

class CalibrationFile : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  void write(const std::string& text) const { std::ofstream(path_) << text; }
  // The message of the Error that reading it throws.
  [[nodiscard]] std::string mistake() const {
    try {
      (void)read_calibration(path_);
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  }

  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() /
      ("occlod_calibration_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + ".json");
};

// Numbers with more digits than are usually printed come back as they were.
TEST_F(CalibrationFile, GivesTheSameNumbersBack) {
  Calibration calibration = round_calibration();
  calibration.visit_ns = 1.0 / 3.0;
  calibration.backends.push_back({"gl-query", 0.1 + 0.2, 2.0 / 3.0, 1e-3, 123456.789, 1e7});
  calibration.devices.assign(hlod::device_presets().begin(), hlod::device_presets().end());
  calibration.devices[0].draw_ns = 10.0 / 3.0;
  calibration.devices[1].latency_commands = 7;
  write_calibration(path_, calibration);
  EXPECT_EQ(read_calibration(path_), calibration);
}

TEST_F(CalibrationFile, RefusesWhatIsNoCalibration) {
  const std::string costs =
      R"("visit_ns": 1, "far_visit_ns": 1, "cone_ns": 1, "split_ns": 1, "kept_split_ns": 1, "triangle_ns": 1, "fragment_ns": 1)";
  const std::string backend =
      R"({"name": "software", "occluder_triangle_ns": 1, "occluder_fragment_ns": 1, "occluder_pixel_ns": 1, "query_ns": 1, "latency_ns": 1})";
  write("{" + costs + R"(, "backends": [)" + backend + "]}");
  EXPECT_EQ(mistake(), "none");
  write("{");
  EXPECT_NE(mistake().find(path_.string()), std::string::npos);
  write("{" + costs + "}");
  EXPECT_NE(mistake().find("backends"), std::string::npos);
  write("{" + costs + R"(, "backends": [], "more": 1})");
  EXPECT_NE(mistake().find("more"), std::string::npos);
  write(
      R"({"visit_ns": 0, "far_visit_ns": 1, "cone_ns": 1, "split_ns": 1, "kept_split_ns": 1, "triangle_ns": 1, "fragment_ns": 1, "backends": [)" +
      backend + "]}");
  EXPECT_NE(mistake().find("/visit_ns"), std::string::npos);
  write(
      R"({"visit_ns": "1", "far_visit_ns": 1, "cone_ns": 1, "split_ns": 1, "kept_split_ns": 1, "triangle_ns": 1, "fragment_ns": 1, "backends": [)" +
      backend + "]}");
  EXPECT_NE(mistake().find("/visit_ns"), std::string::npos);
  write("{" + costs + R"(, "backends": [)" + backend + ", " + backend + "]}");
  EXPECT_NE(mistake().find("/backends/1/name"), std::string::npos);
}

// Files from before HLODs have no devices, and programs without HLODs write none.
TEST_F(CalibrationFile, MayHaveDevices) {
  const std::string json = calibration_json(round_calibration());
  EXPECT_EQ(json.find("devices"), std::string::npos);
  const std::string before = json.substr(0, json.rfind('}'));
  write(before + R"(, "devices": []})");
  EXPECT_EQ(mistake(), "none");
  std::string device =
      R"({"name": "gl", "latency_commands": 0, "draw_ns": 1, "triangle_ns": 1, "fragment_ns": 1, "query_ns": 1, )"
      R"("query_fragment_ns": 1, "wrapped_query_ns": 1, "readback_ns": 1, "batch_ns": 1, "batch_item_ns": 1, )"
      R"("submit_ns": 1, "visit_ns": 0})";
  write(before + R"(, "devices": [)" + device + "]}");
  EXPECT_EQ(mistake(), "none");
  write(before + R"(, "devices": [)" + device + ", " + device + "]}");
  EXPECT_NE(mistake().find("/devices/1/name"), std::string::npos);
  device.replace(device.find(": 1"), 3, ": -1");
  write(before + R"(, "devices": [)" + device + "]}");
  EXPECT_NE(mistake().find("/devices/0/draw_ns"), std::string::npos);
  write(before + R"(, "devices": [{"name": "gl"}]})");
  EXPECT_NE(mistake().find("latency_commands"), std::string::npos);
}

TEST(Calibration, KnowsDevicesByName) {
  Calibration calibration = round_calibration();
  EXPECT_THROW(static_cast<void>(device_costs_of(calibration, "modern")), Error);
  calibration.devices.assign(hlod::device_presets().begin(), hlod::device_presets().end());
  EXPECT_EQ(device_costs_of(calibration, "modern"), hlod::device_preset("modern"));
  calibration.devices[3].query_ns = -1.0;
  EXPECT_THROW(check_calibration(calibration), Error);
}

TEST_F(CalibrationFile, RefusesAFileThatIsNotThere) { EXPECT_NE(mistake().find(path_.string()), std::string::npos); }

TEST(Calibration, RefusesNumbersThatAreNoTimes) {
  EXPECT_NO_THROW(check_calibration(round_calibration()));
  struct Row {
    const char* field;
    std::function<double&(Calibration&)> cost;
  };
  const Row rows[] = {
      {"visit_ns", [](Calibration& c) -> double& { return c.visit_ns; }},
      {"far_visit_ns", [](Calibration& c) -> double& { return c.far_visit_ns; }},
      {"cone_ns", [](Calibration& c) -> double& { return c.cone_ns; }},
      {"split_ns", [](Calibration& c) -> double& { return c.split_ns; }},
      {"kept_split_ns", [](Calibration& c) -> double& { return c.kept_split_ns; }},
      {"triangle_ns", [](Calibration& c) -> double& { return c.triangle_ns; }},
      {"fragment_ns", [](Calibration& c) -> double& { return c.fragment_ns; }},
      {"software.occluder_triangle_ns", [](Calibration& c) -> double& { return c.backends[0].occluder_triangle_ns; }},
      {"software.occluder_fragment_ns", [](Calibration& c) -> double& { return c.backends[0].occluder_fragment_ns; }},
      {"software.occluder_pixel_ns", [](Calibration& c) -> double& { return c.backends[0].occluder_pixel_ns; }},
      {"software.query_ns", [](Calibration& c) -> double& { return c.backends[0].query_ns; }},
      {"software.latency_ns", [](Calibration& c) -> double& { return c.backends[0].latency_ns; }}};
  for (const Row& row : rows)
    for (const double bad :
         {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      Calibration calibration = round_calibration();
      row.cost(calibration) = bad;
      try {
        check_calibration(calibration);
        ADD_FAILURE() << row.field << " may be " << bad;
      } catch (const Error& error) {
        EXPECT_EQ(error.diagnosis().place, std::string("option ") + row.field);
      }
    }
}

// Nothing takes no time; how much each thing takes is the machine's to say.
TEST(Calibration, MeasuresEverything) {
  std::vector<std::unique_ptr<Visibility>> backends;
  backends.push_back(make_software_occlusion());
  const Calibration calibration = measure_calibration(backends);
  EXPECT_GE(calibration.far_visit_ns, calibration.visit_ns);
  for (const double ns : {calibration.visit_ns, calibration.cone_ns, calibration.split_ns, calibration.kept_split_ns,
                          calibration.triangle_ns, calibration.fragment_ns})
    EXPECT_GT(ns, 0.0);
  ASSERT_EQ(calibration.backends.size(), 1U);
  const BackendCosts& costs = calibration.backends.front();
  EXPECT_EQ(costs.name, "software");
  for (const double ns : {costs.occluder_triangle_ns, costs.occluder_fragment_ns, costs.occluder_pixel_ns,
                          costs.query_ns, costs.latency_ns})
    EXPECT_GT(ns, 0.0);
  // A query among many takes no longer than one that is waited for.
  EXPECT_LE(costs.query_ns, costs.latency_ns);
}

}  // namespace
}  // namespace occlod::test
