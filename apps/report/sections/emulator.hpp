#pragma once
/// The section on the emulator of MAP and of the posterior: nuisances, runs and errors of the emulator, and the covariance of the errors.
#include "apps/report/data/study.hpp"
#include "apps/report/parts/table.hpp"

namespace calomel {

/// The nuisances with their priors and their prior deviations: viscosity, Young's modulus of the steel and the multiple beyond the finest mesh. Empty without
/// map.json.
Table nuisance_table(const Study& study);
/// The ten marginalised numbers with the largest prior deviations, from map.json, else from posterior.json.
Table prior_deviation_table(const Study& study);
/// Runs, leave-one-out error and numerical noise by mesh, from the same file.
Table emulator_table(const Study& study);
/// Shares of the terms in the trace of the covariance of the errors, largest first, from the same file.
Table share_table(const Study& study);

/// The body of the section: identified quantities, adequacy of the fit, whether the emulator settled and agrees with the true model, and the tables.
/// Empty without MAP and posterior.
Html emulator_section(const Study& study);

}  // namespace calomel
