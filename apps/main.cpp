#include <iostream>

#include "apps/exit_status.hpp"
#include "apps/interrupt.hpp"
#include "apps/verbs.hpp"

namespace calomel {

std::vector<Verb> verbs() {
  return {{"check", "check the whole case; print what will be run and its cost", Takes::case_file, run_check},
          {"simulate", "one run of the case's model", Takes::case_file, run_simulate},
          {"campaign", "run the model over a design of experiments; resumes after any interruption", Takes::case_file, run_campaign_verb},
          {"train", "train surrogates on the campaign", Takes::case_file, run_train},
          {"calibrate", "fit the parameters to the recordings", Takes::case_file, run_calibrate},
          {"sample", "the posterior of the parameters by Markov chains on the multilevel emulator", Takes::case_file, run_sample},
          {"sensitivity", "which parameters the records depend on", Takes::case_file, run_sensitivity},
          {"diagnose", "where simulation and recordings differ, and which physics was left out", Takes::case_file, run_diagnose},
          {"report", "one self-contained page of results", Takes::case_file, run_report},
          {"study", "the stages of [study], reusing finished ones", Takes::case_file, run_study},
          {"import", "recordings in CSV or text to recordings.nc", Takes::files, run_import},
          {"serve", "the case's model behind HTTP, UM-Bridge 1.0", Takes::case_file, run_serve},
          {"challenge", "make, diagnose and score cases with concealed physics: how far a diagnosis is to be believed", Takes::suite, run_challenge},
          {"list", "laws, loads, mechanisms, designs, surrogates, objectives, optimisers, samplers", Takes::nothing, run_list}};
}

}  // namespace calomel

int main(int argc, char** argv) {
  using namespace calomel;
  return guarded(
      [&] {
        const auto all = verbs();
        CommandLine command;
        if (!parse(std::vector<std::string>(argv + 1, argv + argc), all, command, std::cout)) return ExitStatus::done;
        listen_for_interrupts();
        for (const auto& v : all)
          if (v.name == command.verb) return v.run(command);
        expect(false, "the parser gives the name of a verb");
        return ExitStatus::done;
      },
      std::cerr);
}
