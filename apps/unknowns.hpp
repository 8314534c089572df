#pragma once
/// What no case file tells exactly: the steel's stiffness and where the gauges sit. Their effect on the records by secants of the true model.
#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "forward/built_in_model.hpp"
#include "inverse/map.hpp"

namespace calomel {

/// The ensemble mean of a changed case at theta, (values); empty where the case cannot be made or its run fails.
std::vector<double> mean_of_changed(const BuiltInModel& model, std::span<const double> theta, const std::function<void(ForwardCase&)>& change);

/// Changes of the ensemble mean at `theta` by one standard deviation of each unknown, (values, 1 + gauges): the steel's Young modulus, common to all
/// gauges, by a central secant of 2 %; the place of each gauge along its direction, a column each, by a secant of half an element or the sd, whichever is
/// more. A column of 0 where its runs failed or it is itself a parameter. Four runs of the model, on `threads` threads.
Eigen::MatrixXd unknown_directions(const BuiltInModel& model, std::span<const double> theta, const UnknownOptions& options, int threads);

}  // namespace calomel
