#pragma once
/// The report: one self-contained page (report.html) and, on request, every table and trace of it as CSV.
#include <filesystem>
#include <string>
#include <vector>

#include "apps/report/data/report_input.hpp"

namespace calomel {

/// Checks that `out_dir` holds an artefact of some stage.
/// Errors: InputError that names the folder and the command to run first.
void expect_something_to_report(const std::filesystem::path& out_dir, const std::string& case_file);

/// Writes out_dir/report.html from the artefacts in `out_dir` (campaign, train, simulate, enc, spe, map, posterior, diagnosis, sensitivity).
/// A section whose artefact is missing names the command that makes it. The page loads nothing from outside and remains below 10 MB; traces and surfaces are
/// thinned as far as needed. Errors: InputError when there is no artefact, when an artefact cannot be read, or when the page cannot be written.
void write_report(const std::filesystem::path& out_dir, const ReportInput& input);

/// Writes every table and trace, unthinned, to out_dir/report_csv/*.csv and returns the paths. Files have commas, decimal points and one header line; times are
/// in seconds, strains in microstrain. Errors: those of write_report.
std::vector<std::filesystem::path> write_tables_csv(const std::filesystem::path& out_dir, const ReportInput& input);

}  // namespace calomel
