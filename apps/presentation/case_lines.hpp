#pragma once
/// Sentences about a case before it is run: its model, its physics, its study and the cost.
#include <optional>
#include <string>
#include <vector>

#include "apps/inputs/study_case.hpp"
#include "base/errors.hpp"
#include "forward/simulation/simulator.hpp"
#include "inverse/data/problem.hpp"

namespace calomel {

/// Estimated wall times [s].
struct StudyCost {
  double run = 0;        ///< one run of every condition
  double campaign = 0;   ///< its ensemble means
  double floor = 0;      ///< the repeatability floor
  double posterior = 0;  ///< the runs that the emulator of a posterior begins with; 0 where none is requested
  double diagnosis = 0;  ///< as many as diagnosis.max_runs allows
};

/// What `check` shows.
struct StudyPlan {
  const StudyCase& study;
  const Description& model;
  const Problem* problem = nullptr;  ///< null without recordings
  std::optional<StudyCost> cost;     ///< of a model whose runs are long enough to count
  int threads = 1;                   ///< of this call
};

/// What will be run and what it costs, a screenful.
std::vector<std::string> plan_lines(const StudyPlan& plan);

/// "label: text", a line each.
std::vector<std::string> fact_lines(const std::vector<Fact>& facts);

std::string mesh_written_line(const std::filesystem::path& file);

/// One for every parameter whose nominal value is another than the number of the tables, which simulate takes: what to set in its place, at its place in the
/// case.
std::vector<InputError> nominals_left_out(const StudyCase& study);

/// "5 of the listed mechanisms are not built yet in this version and take no part"
std::string unbuilt_mechanisms_sentence(std::size_t mechanisms);

}  // namespace calomel
