#pragma once
/// Sentences about the stages that run the model or train on its runs, and about what a stage finds or makes before it.
#include <filesystem>
#include <string>
#include <vector>

#include "forward/simulation/simulator.hpp"
#include "forward/campaign/archive.hpp"
#include "forward/campaign/campaign.hpp"
#include "forward/surrogate/feasibility.hpp"
#include "forward/surrogate/training.hpp"
#include "inverse/data/recordings.hpp"

namespace calomel {

/// "STAGE: SENTENCE": a sentence about a stage.
std::string stage_line(const std::string& stage, const std::string& sentence);
/// The line of a finished stage.
std::string reused_line(const std::string& stage);
/// What a stage needs is not in `out`: "no repeatability floor in OUT: measuring it first".
std::string made_first_line(const std::string& what, const std::filesystem::path& out, const std::string& doing);

/// One line each for the floor, its gauges and the other numerical errors.
std::vector<std::string> floor_lines(const RepeatabilityFloor& floor);

/// For the progress display; empty when none failed.
std::string failed_note(std::size_t failed);
std::string campaign_line(const CampaignSummary& summary);
/// Why runs of a campaign failed and how well the boundary is known; none when none failed.
std::vector<std::string> failure_lines(const Archive& archive, const Feasibility& feasibility);

/// A line a surrogate.
std::vector<std::string> train_lines(const TrainSummary& summary);

/// A simulation that was interrupted. `which`: its condition, empty when there is one. It is kept when `finished`, else it goes on from `step`.
std::string resumed_line(const std::string& which, std::int64_t step, bool finished);
/// Size and speed of a run; of a model of this many values without elements, its time.
std::string simulate_line(const Simulated& simulated, std::size_t values);

std::string report_line(const std::filesystem::path& page);
std::string report_tables_line(std::size_t tables, const std::filesystem::path& folder);
std::string import_line(const ImportSummary& summary);

}  // namespace calomel
