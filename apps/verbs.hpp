#pragma once
/// The verbs of the program; each is one file of this folder.
#include <vector>

#include "apps/command_line.hpp"

namespace calomel {

ExitStatus run_check(const CommandLine& command);
ExitStatus run_simulate(const CommandLine& command);
ExitStatus run_campaign_verb(const CommandLine& command);
ExitStatus run_train(const CommandLine& command);
ExitStatus run_calibrate(const CommandLine& command);
ExitStatus run_sample(const CommandLine& command);
ExitStatus run_sensitivity(const CommandLine& command);
ExitStatus run_diagnose(const CommandLine& command);
ExitStatus run_report(const CommandLine& command);
ExitStatus run_study(const CommandLine& command);
ExitStatus run_import(const CommandLine& command);
ExitStatus run_serve(const CommandLine& command);
ExitStatus run_challenge(const CommandLine& command);
ExitStatus run_list(const CommandLine& command);

/// In the order of --help.
std::vector<Verb> verbs();

}  // namespace calomel
