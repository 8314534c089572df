#pragma once
/// Options of the train stage, table `[surrogate]`.
#include <string>
#include <vector>

#include "base/options.hpp"
#include "forward/surrogate/modes.hpp"

namespace calomel {

/// Small smooth networks on the modes, `[surrogate.mode_network]`.
struct ModeNetworkOptions {
  std::vector<int> layers = {64, 64, 64};
  std::string activation = "silu";
  int members = 4;
  int passes_per_epoch = 10;
  double learning_rate = 4e-3;
  int batch_size = 16;
  std::vector<double> weight_decay = {0.03, 0.3, 1.0};
  double whitening = 0;

  template <class V>
  void visit(V& v) {
    v("layers", layers, {.range = at_least(1), .doc = "widths of the hidden layers", .least_size = 1});
    v("activation", activation, {.doc = "of the hidden layers", .choices = {"relu", "tanh", "silu"}});
    v("members", members, {.range = between(1, 100), .doc = "networks from different starts whose mean is the surrogate"});
    v("passes_per_epoch", passes_per_epoch,
      {.range = between(1, 10000), .doc = "passes over the runs that make one of surrogate.epochs: a pass here is that much cheaper"});
    v("learning_rate", learning_rate, {.range = above(0), .doc = "initial rate of Adam"});
    v("batch_size", batch_size, {.range = at_least(1), .doc = "runs in a mini-batch"});
    v("weight_decay", weight_decay, {.range = at_least(0), .doc = "decoupled weight decays to choose from on a fifth of the training runs", .least_size = 1});
    v("whitening", whitening, {.range = between(0, 1), .doc = "1: every mode counts alike in the loss; 0: as much as its share of the histories"});
  }
};

/// Gaussian processes on the modes, `[surrogate.gaussian_process]`.
struct GaussianProcessOptions {
  int iterations = 60;

  template <class V>
  void visit(V& v) {
    v("iterations", iterations, {.range = between(1, 10000), .doc = "at most so many steps in search of a mode's length scales, warps and nugget"});
  }
};

struct SurrogateOptions {
  std::string kind = "mode_gaussian_process";
  std::vector<std::string> compare = {"network", "mode_network"};
  double test_fraction = 0.2;
  int epochs = 100;
  double learning_rate = 9.5e-4;
  double plateau_factor = 0.95;
  int plateau_patience = 5;
  int batch_size = 8;
  std::vector<int> layers = {242, 191, 128, 108, 94, 72};
  std::string activation = "relu";
  std::string loss = "mae";
  ModeOptions modes;
  ModeNetworkOptions mode_network;
  GaussianProcessOptions gaussian_process;

  template <class V>
  void visit(V& v) {
    v("kind", kind, {.doc = "the surrogate that replaces the model in later stages (`calomel list` names them)"});
    v("compare", compare, {.doc = "further kinds, trained on the same runs and reported beside it"});
    v("test_fraction", test_fraction, {.range = between(0.05, 0.5), .doc = "share of the runs that is held out"});
    v("epochs", epochs, {.range = between(1, 1000000), .doc = "training length of the networks"});
    v("learning_rate", learning_rate, {.range = above(0), .doc = "network: initial rate of Adam"});
    v("plateau_factor", plateau_factor, {.range = {.low = 0, .high = 1, .low_open = true}, .doc = "networks: the rate is multiplied by it on a plateau"});
    v("plateau_patience", plateau_patience, {.range = at_least(1), .doc = "networks: epochs without improvement of the training loss that are a plateau"});
    v("batch_size", batch_size, {.range = at_least(1), .doc = "network: runs in a mini-batch"});
    v("layers", layers, {.range = at_least(1), .doc = "network: widths of the hidden layers", .least_size = 1});
    v("activation", activation, {.doc = "network: of the hidden layers", .choices = {"relu", "tanh", "silu"}});
    v("loss", loss, {.doc = "network: mean absolute or mean squared error", .choices = {"mae", "mse"}});
    v.table("modes", modes, "proper orthogonal modes of the histories");
    v.table("mode_network", mode_network, "small networks on the modes");
    v.table("gaussian_process", gaussian_process, "Gaussian processes on the modes");
  }
  /// Errors: InputError for an unknown kind, or one that is listed twice.
  void validate() const;
};

}  // namespace calomel
