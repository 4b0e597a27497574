#include "core/sph/enthalpy.h"

#include "core/sph/rheology.h"

#include <gtest/gtest.h>

#include <cmath>

namespace smelt {
namespace {

HeatProperties wax(double hot) {
  HeatProperties heat{1e-7, 330.0, hot};
  heat.specific_heat = 2000.0;
  heat.latent_heat = 2e5;
  return heat;
}

TEST(Enthalpy, TemperatureIsItsInverseOverARange) {
  const HeatProperties heat = wax(340.0);
  for (const double t : {0.0, 299.0, 330.0, 331.0, 337.5, 340.0, 412.0})
    EXPECT_NEAR(temperature_at_enthalpy(heat, enthalpy_at(heat, t)), t, 1e-12 * 400.0);
  EXPECT_DOUBLE_EQ(enthalpy_at(heat, 330.0), 0.0);
  EXPECT_DOUBLE_EQ(enthalpy_at(heat, 340.0), 2000.0 * 10.0 + 2e5);
  EXPECT_DOUBLE_EQ(enthalpy_at(heat, 335.0), 0.5 * (2000.0 * 10.0 + 2e5));
  EXPECT_DOUBLE_EQ(enthalpy_at(heat, 341.0) - enthalpy_at(heat, 340.0), 2000.0);
}

TEST(Enthalpy, TemperatureStandsStillOnASharpMeltingPoint) {
  const HeatProperties heat = wax(330.0);
  EXPECT_DOUBLE_EQ(enthalpy_at(heat, 330.0), 0.0) << "solid at the melting point";
  for (const double h : {0.0, 1e5, 1.999e5}) EXPECT_DOUBLE_EQ(temperature_at_enthalpy(heat, h), 330.0);
  EXPECT_DOUBLE_EQ(temperature_at_enthalpy(heat, 2e5 + 2000.0), 331.0);
  EXPECT_DOUBLE_EQ(melted_fraction_at_enthalpy(heat, 5e4), 0.25);
  EXPECT_DOUBLE_EQ(melted_fraction_at_enthalpy(heat, -1.0), 0.0);
  EXPECT_DOUBLE_EQ(melted_fraction_at_enthalpy(heat, 3e5), 1.0);
}

TEST(Enthalpy, SlopeIsThatOfTemperature) {
  for (const double hot : {330.0, 340.0}) {
    const HeatProperties heat = wax(hot);
    for (const double h : {-3e4, 1e4, 1.5e5, 4e5}) {
      const double step = 10.0;
      const double difference =
          (temperature_at_enthalpy(heat, h + step) - temperature_at_enthalpy(heat, h - step)) / (2.0 * step);
      EXPECT_NEAR(temperature_slope(heat, h), difference, 1e-9 * (1.0 / 2000.0) + 1e-14);
    }
  }
}

TEST(ThermalLaw, TableGoesThroughItsPointsGeometrically) {
  ThermalRange table;
  table.law = ThermalLaw::table;
  table.temperature = {300.0, 320.0, 360.0};
  table.value = {1e6, 1e2, 0.0};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_DOUBLE_EQ(value_at(table, nan, 200.0), 1e6);
  EXPECT_DOUBLE_EQ(value_at(table, nan, 300.0), 1e6);
  EXPECT_NEAR(value_at(table, nan, 310.0), 1e4, 1e-8);
  EXPECT_DOUBLE_EQ(value_at(table, nan, 320.0), 1e2);
  EXPECT_DOUBLE_EQ(value_at(table, nan, 340.0), 50.0) << "linear towards 0";
  EXPECT_DOUBLE_EQ(value_at(table, nan, 999.0), 0.0);
  EXPECT_FALSE(is_zero(table));
}

TEST(ThermalLaw, ExponentialWithinItsBounds) {
  ThermalRange law;
  law.law = ThermalLaw::exponential;
  law.reference = 100.0;
  law.reference_temperature = 1400.0;
  law.rate = 0.04;
  law.coldest = 1100.0;
  law.hottest = 1500.0;
  EXPECT_DOUBLE_EQ(value_at(law, 0.0, 1400.0), 100.0);
  EXPECT_NEAR(value_at(law, 0.0, 1300.0), 100.0 * std::exp(4.0), 1e-9);
  EXPECT_DOUBLE_EQ(value_at(law, 0.0, 300.0), 100.0 * std::exp(12.0)) << "no colder than coldest";
  EXPECT_DOUBLE_EQ(value_at(law, 0.0, 2000.0), 100.0 * std::exp(-4.0));
}

TEST(ThermalLaw, FlowCurveReadsEachPropertyByItsOwnLaw) {
  Rheology rheology;
  rheology.yield_stress = {100.0, 0.0};
  rheology.consistency.law = ThermalLaw::table;
  rheology.consistency.temperature = {300.0, 400.0};
  rheology.consistency.value = {1000.0, 10.0};
  rheology.rest_viscosity = ThermalRange{5.0, 5.0};
  const FlowCurve curve = flow_curve_at(rheology, 0.5, 350.0);
  EXPECT_DOUBLE_EQ(curve.yield_stress, 50.0);
  EXPECT_NEAR(curve.consistency, 100.0, 1e-10);
  EXPECT_TRUE(std::isnan(flow_curve_at(rheology, 0.5).consistency)) << "a table without a temperature";
}

}  // namespace
}  // namespace smelt
