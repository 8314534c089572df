#pragma once
/// What people are told of the stages that run the model and learn from its runs, and of what a stage finds or has made before it.
#include <filesystem>
#include <string>
#include <vector>

#include "forward/campaign/archive.hpp"
#include "forward/campaign/campaign.hpp"
#include "forward/surrogate/feasibility.hpp"
#include "forward/surrogate/training.hpp"
#include "inverse/data/recordings.hpp"

namespace calomel {

/// "STAGE: SENTENCE": what a stage itself has to say.
std::string stage_line(const std::string& stage, const std::string& sentence);
/// Of a stage that stands finished.
std::string reused_line(const std::string& stage);
/// What a stage needs is not in `out`: "no repeatability floor in OUT: measuring it first".
std::string made_first_line(const std::string& what, const std::filesystem::path& out, const std::string& doing);

/// A line each for the floor, its gauges and what stands beside it.
std::vector<std::string> floor_lines(const RepeatabilityFloor& floor);

/// For the progress display; empty when none failed.
std::string failed_note(std::size_t failed);
std::string campaign_line(const CampaignSummary& summary);
/// Why runs of a campaign failed and how well the boundary is known; none when none failed.
std::vector<std::string> failure_lines(const Archive& archive, const Feasibility& feasibility);

/// A line a surrogate.
std::vector<std::string> train_lines(const TrainSummary& summary);

/// A simulation of several conditions that was cut off. `which` of them, empty when there is one: kept when `finished`, else gone on with.
std::string resumed_line(const std::string& which, std::int64_t step, bool finished);
struct SimulatedSpeed {
  std::size_t elements = 0;
  std::int64_t steps = 0;
  double wall = 0;           ///< [s]
  double element_steps = 0;  ///< [1/s]
};
std::string simulate_line(const SimulatedSpeed& speed);

std::string report_line(const std::filesystem::path& page);
std::string report_tables_line(std::size_t tables, const std::filesystem::path& folder);
std::string import_line(const ImportSummary& summary);

}  // namespace calomel
