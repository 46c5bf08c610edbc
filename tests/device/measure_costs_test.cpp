// What commands cost, measured where it is known.
#include <gtest/gtest.h>

#include "occlod/device.h"
#include "papers/trial_devices.h"

namespace occlod::hlod {
namespace {

void expect_costs(const DeviceCosts& measured, const DeviceCosts& costs) {
  EXPECT_NEAR(measured.draw_ns, costs.draw_ns, 1e-6 * costs.draw_ns);
  EXPECT_NEAR(measured.triangle_ns, costs.triangle_ns, 1e-6 * costs.triangle_ns);
  EXPECT_NEAR(measured.fragment_ns, costs.fragment_ns, 1e-6 * costs.fragment_ns);
  EXPECT_NEAR(measured.query_ns, costs.query_ns, 1e-6 * costs.query_ns);
  EXPECT_NEAR(measured.query_fragment_ns, costs.query_fragment_ns, 1e-6 * costs.query_fragment_ns);
  EXPECT_NEAR(measured.wrapped_query_ns, costs.wrapped_query_ns, 1e-6 * costs.wrapped_query_ns);
  EXPECT_NEAR(measured.readback_ns, costs.readback_ns, 1e-6 * costs.readback_ns);
  EXPECT_NEAR(measured.batch_ns, costs.batch_ns, 1e-6 * costs.batch_ns);
  EXPECT_NEAR(measured.batch_item_ns, costs.batch_item_ns, 1e-6 * costs.batch_item_ns);
  EXPECT_NEAR(measured.submit_ns, costs.submit_ns, 1e-6 * costs.submit_ns);
  EXPECT_NEAR(measured.visit_ns, costs.visit_ns, 1e-6 * costs.visit_ns);
}

// Each time is asked for by itself, so what a device was given comes back: no stage hides another.
TEST(MeasureCosts, FindsWhatASimulatedDeviceWasGiven) {
  for (const DeviceCosts& costs : device_presets()) {
    SCOPED_TRACE(costs.name);
    VirtualDevice device(costs);
    const DeviceCosts measured = measure_costs(device);
    EXPECT_EQ(measured.name, "virtual:" + costs.name);
    expect_costs(measured, costs);
  }
}

// What a program cannot give faster costs as long as giving it.
TEST(MeasureCosts, FindsTheProcessorWhereItIsTheSlower) {
  DeviceCosts costs = device_preset("modern");
  costs.submit_ns = 5000.0;
  VirtualDevice device(costs);
  const DeviceCosts measured = measure_costs(device);
  EXPECT_NEAR(measured.draw_ns, 5000.0, 1e-3);
  EXPECT_NEAR(measured.query_ns, 5000.0, 1e-3);
}

TEST(MeasureCosts, FindsSomethingOnARealDevice) {
  SoftwareDevice device;
  const DeviceCosts measured = measure_costs(device);
  for (const double ns : {measured.draw_ns, measured.triangle_ns, measured.fragment_ns, measured.query_ns,
                          measured.query_fragment_ns, measured.wrapped_query_ns, measured.readback_ns,
                          measured.batch_ns, measured.batch_item_ns, measured.submit_ns, measured.visit_ns})
    EXPECT_GT(ns, 0.0);
}

}  // namespace
}  // namespace occlod::hlod
