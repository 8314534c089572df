#pragma once
/// Numbers that may be added to a model in a block: a mechanism that the case leaves out, or numbers of the numerics that act like one.
#include <map>
#include <span>
#include <string>
#include <vector>

#include "forward/parameter.hpp"

namespace calomel {

/// A number beside the parameters of a model. `parameter.nominal` is the value that switches it off.
struct AddedParameter {
  Parameter parameter;            ///< its key is the dotted key of the case, its name "GROUP.KEY"
  bool inverse = false;           ///< the case's number is 1 / value, none (infinite) at 0
  std::string share_of;           ///< dotted key of the number that the case's number is `value` times of: off at 1, where its law sets in at once; empty: none
  double whole = 1;               ///< that number in the case, where no parameter sets it; 1 of a value that is no share
  std::vector<double> strengths;  ///< values at which its effect is first looked at
  std::vector<std::pair<std::string, double>> with;  ///< dotted keys that are set while it is on: the wall that it is about
  std::string unit, doc;                             ///< of the case's number
};

struct ParameterGroup {
  std::string name;                    ///< of the mechanism
  std::string place;                   ///< word that distinguishes it from others of the name, such as a wall or a law; empty where there is one
  std::vector<AddedParameter> added;   ///< at least one
  std::vector<AddedParameter> shapes;  ///< change what the others look like and do nothing without them; `nominal` is their default
  bool law = false;                    ///< `place` is the word for one of the mechanism's laws
  bool part = false;                   ///< of a place that another group of the name is about as a whole
  bool by_sensor = false;              ///< acts on each gauge alone
  std::string sensor;                  ///< acts on this gauge alone; empty: on no one of them
  bool linear = false;                 ///< many numbers of one kind, small each: its effect is taken for linear in them about where they are
  bool numerical = false;              ///< no physics: numbers of the solver
  bool like_the_mesh = false;          ///< MechanismEntry::like_the_mesh
  double cost = 1;                     ///< of a run with it over one of the base model
  std::string plain, check;            ///< MechanismEntry's
};

/// Sets the numbers of the case to `values` (added), by dotted key. A value at its nominal is left alone: with all of them there a run is the base
/// model's.
void set_added(std::map<std::string, double>& numbers, std::span<const double> values, std::span<const AddedParameter> added);

}  // namespace calomel
