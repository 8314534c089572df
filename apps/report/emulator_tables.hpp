#pragma once
/// What MAP and the posterior stand on: nuisances, the emulator's runs and errors, the shares of the errors' covariance.
#include <string>

#include "apps/report/report.hpp"
#include "apps/report/study.hpp"
#include "apps/report/table.hpp"

namespace calomel {

/// Viscosity, the steel's modulus and the multiple beyond the finest mesh with their priors and how far the records pull them. Empty without map.json.
Table nuisance_table(const Study& study);
/// What the records say of the numbers that are marginalised, the ten that are farthest from what was said of them, of the same.
Table pull_table(const Study& study);
/// Runs, left-out error and numerical noise by mesh, of map.json, else of posterior.json.
Table emulator_table(const Study& study);
/// Shares of the terms in the trace of the errors' covariance, greatest first, of the same.
Table share_table(const Study& study);
/// The section: what the data pin, whether the fit is adequate, whether the emulator settled and the true model lies where it says, and the tables.
/// Empty where there is neither MAP nor a posterior.
std::string emulator_section(const Study& study);

}  // namespace calomel
