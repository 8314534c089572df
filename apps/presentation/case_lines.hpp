#pragma once
/// What people are told of a case before it is run: its model, its physics, its study and what that costs.
#include <string>
#include <vector>

#include "apps/inputs/study_case.hpp"
#include "base/errors.hpp"
#include "forward/built_in_model.hpp"
#include "inverse/data/problem.hpp"

namespace calomel {

/// Estimated wall times [s].
struct StudyCost {
  double run = 0;        ///< one run of every condition
  double campaign = 0;   ///< its ensemble means
  double floor = 0;      ///< the repeatability floor
  double posterior = 0;  ///< the runs that the emulator of a posterior begins with; 0 where none is asked for
  double diagnosis = 0;  ///< as many as diagnosis.max_runs allows
};

/// What `check` tells of.
struct StudyPlan {
  const StudyCase& study;
  const ModelDescription& model;
  const ModelShape& shape;
  const Mesh& mesh;
  const Problem* problem = nullptr;  ///< null without recordings
  StudyCost cost;
  int threads = 1;  ///< of this call
};

/// What will be run and what it costs, a screenful.
std::vector<std::string> plan_lines(const StudyPlan& plan);

/// The load's policy, and of a pulse the deposited energy and the viscosity: every run tells them.
std::vector<std::string> physics_lines(const LoadOptions& load, const ModelDescription& model, bool plane_strain);

std::string mesh_written_line(const std::filesystem::path& file);

/// One for every parameter whose nominal value is another than the number of the tables, which simulate takes: what to set in its place, at its place in the
/// case.
std::vector<InputError> nominals_left_out(const StudyCase& study);

/// "5 of the listed mechanisms are not built yet in this version and take no part"
std::string unbuilt_mechanisms_sentence(std::size_t mechanisms);

}  // namespace calomel
