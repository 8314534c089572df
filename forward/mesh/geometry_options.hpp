#pragma once
/// The parametric targets of a case file, `[geometry]`.
#include <filesystem>
#include <optional>
#include <string>

#include "base/options.hpp"

namespace calomel {

/// Wall thicknesses [m] that differ from `wall`.
struct WallOptions {
  std::optional<double> front, rear, side, top, bottom;
  template <class V>
  void visit(V& v) {
    v("front", front, {.unit = "m", .range = above(0), .doc = "thickness of the front wall"});
    v("rear", rear, {.unit = "m", .range = above(0), .doc = "thickness of the rear wall (unused when the rear is non-reflecting)"});
    v("side", side, {.unit = "m", .range = above(0), .doc = "thickness of the side walls"});
    v("top", top, {.unit = "m", .range = above(0), .doc = "thickness of the top wall"});
    v("bottom", bottom, {.unit = "m", .range = above(0), .doc = "thickness of the bottom wall"});
  }
};

/// The steel plates inside a jet-flow target. Both come from the rear end, parallel to the bottom and the top wall, and
/// follow the nose; between their ends the jet runs along the window and turns into the middle.
struct JetOptions {
  double channel = 0.02;
  double thickness = 0.005;
  double lower_turn = 50;
  double upper_turn = 0;
  template <class V>
  void visit(V& v) {
    v("channel", channel, {.unit = "m", .range = above(0), .doc = "clear height of the mercury channel between wall and plate"});
    v("thickness", thickness, {.unit = "m", .range = at_least(0), .doc = "thickness of the plates; 0 leaves them out"});
    v("lower_turn", lower_turn, {.unit = "deg", .range = between(0, 85), .doc = "angle by which the lower plate follows the nose"});
    v("upper_turn", upper_turn, {.unit = "deg", .range = between(0, 85), .doc = "angle by which the upper plate follows the nose"});
  }
};

/// Names of the sets of a mesh file (kind = "mesh"); case does not matter. An empty list represents the default.
struct SetOptions {
  std::vector<std::string> steel, mercury, symmetry_x, symmetry_y, symmetry_z, rear, loaded, outer;
  template <class V>
  void visit(V& v) {
    v("steel", steel, {.doc = "mesh: element sets, blocks or materials of steel (default: those whose name contains \"steel\")"});
    v("mercury", mercury, {.doc = "mesh: those of mercury (default: those whose name contains \"mercury\")"});
    v("symmetry_x", symmetry_x,
      {.doc = "mesh: node or side sets of a symmetry plane normal to x (default: a set of this name, if any; so for the keys below)"});
    v("symmetry_y", symmetry_y, {.doc = "mesh: normal to y; sets on both sides of one layer of elements make plane strain"});
    v("symmetry_z", symmetry_z, {.doc = "mesh: normal to z"});
    v("rear", rear, {.doc = "mesh: node or side sets of the non-reflecting mercury faces"});
    v("loaded", loaded, {.doc = "mesh: node or side sets of the faces on which an end_stress acts"});
    v("outer", outer, {.doc = "mesh: node or side sets of the surface on which gauges may be placed (default: all free steel faces)"});
  }
  /// The lists by their keys.
  [[nodiscard]] std::vector<std::pair<std::string, const std::vector<std::string>*>> by_key() const {
    return {{"steel", &steel},           {"mercury", &mercury}, {"symmetry_x", &symmetry_x}, {"symmetry_y", &symmetry_y},
            {"symmetry_z", &symmetry_z}, {"rear", &rear},       {"loaded", &loaded},         {"outer", &outer}};
  }
};

/// Outer dimensions, walls and mesh of a target. x runs along the beam and is 0 at the outer front face, z is 0 at the
/// outer bottom face, y is 0 in the middle.
struct GeometryOptions {
  std::string kind;                             ///< box | jet_flow | bar | mesh
  std::optional<double> length, width, height;  ///< outer [m]
  std::optional<double> wall;                   ///< thickness of walls that `walls` omits [m]
  WallOptions walls;
  std::string rear = "non_reflecting";  ///< | wall
  bool plane_strain = false;
  bool half = false;
  bool quarter = true;                 ///< bar
  std::optional<double> radius;        ///< bar [m]
  std::optional<double> nose_radius;   ///< jet_flow [m]
  std::optional<double> window;        ///< jet_flow [m]
  JetOptions jet;                      ///< jet_flow
  std::optional<double> element_size;  ///< upper bound [m]
  int wall_elements = 0;
  std::string wetted = "slip";  ///< | no_separation | tied
  std::string file;             ///< kind = "mesh"
  double scale = 1, merge_distance = 0;
  SetOptions sets;
  double max_elements = 2e8;

  std::filesystem::path folder;  ///< where a relative `file` starts; no key

  /// Whether steel and mercury have nodes of their own on wetted faces.
  [[nodiscard]] bool slips() const { return wetted != "tied"; }
  /// Whether these may come apart.
  [[nodiscard]] bool parts() const { return wetted == "slip"; }

  template <class V>
  void visit(V& v) {
    v("kind", kind, {.doc = "shape of the target", .required = true, .choices = {"box", "jet_flow", "bar", "mesh"}});
    v("length", length, {.unit = "m", .range = above(0), .doc = "outer length along x (jet_flow: 0.55)"});
    v("width", width, {.unit = "m", .range = above(0), .doc = "outer width along y (jet_flow: 0.4)"});
    v("height", height, {.unit = "m", .range = above(0), .doc = "outer height along z (jet_flow: 0.12)"});
    v("wall", wall, {.unit = "m", .range = above(0), .doc = "thickness of the walls that `walls` does not name (jet_flow: 0.004)"});
    v.table("walls", walls, "thicknesses of single walls");
    v("rear", rear, {.doc = "rear end: mercury continues behind it, or a steel wall", .choices = {"non_reflecting", "wall"}});
    v("plane_strain", plane_strain, {.doc = "box: one element across y, no side walls, no motion along y"});
    v("half", half, {.doc = "keep y >= 0 only, with a symmetry plane; gauges are mirrored into it"});
    v("quarter", quarter, {.doc = "bar: keep y >= 0 and z >= 0 only, with symmetry planes; gauges are mirrored into it"});
    v("radius", radius, {.unit = "m", .range = above(0), .doc = "bar: radius"});
    v("nose_radius", nose_radius, {.unit = "m", .range = above(0), .doc = "jet_flow: outer radius of the nose (default: half the height)"});
    v("window", window, {.unit = "m", .range = above(0), .doc = "jet_flow: wall thickness at the tip of the nose (default 0.002)"});
    v.table("jet", jet, "jet_flow: the plates that lead a jet along the window");
    v("element_size", element_size,
      {.unit = "m",
       .range = above(0),
       .doc = "longest element edge wanted; layers are divided evenly, the nose of jet_flow half way down its layers (jet_flow: 0.003, bar: radius/4)"});
    v("wall_elements", wall_elements, {.range = at_least(0), .doc = "elements through every wall; 0 = by element_size, but at least 2"});
    v("wetted", wetted,
      {.doc = "steel and mercury slip along each other and separate where the mercury cavitates, slip and never separate, or share nodes",
       .choices = {"slip", "no_separation", "tied"}});
    v("file", file, {.doc = "mesh: Exodus II file (.exo, .e, .g), or Abaqus input (.inp)"});
    v("scale", scale, {.range = above(0), .doc = "mesh: factor on the coordinates, 0.001 for a file in millimetres"});
    v("merge_distance", merge_distance, {.unit = "m", .range = at_least(0), .doc = "mesh: nodes nearer than this become one; 0 = none do"});
    v.table("sets", sets, "mesh: meaning of the sets of the file");
    v("max_elements", max_elements, {.range = between(1, 3e8), .doc = "refuse a mesh of more elements than this"});
  }

  /// Errors: InputError on the key that is missing, does not belong to the kind, leaves no mercury, or needs more
  /// than `max_elements`. Nothing is allocated.
  void validate() const;
  void validate_mesh_file() const;

  [[nodiscard]] std::filesystem::path mesh_file() const { return folder / file; }

  /// Thickness [m] of "front", "rear", "side", "top" or "bottom". Errors: InputError when neither `walls` nor `wall` gives it.
  [[nodiscard]] double wall_thickness(const std::string& name) const;
  /// Whether mercury may touch that wall, "front", "rear", "side", "top", "bottom" or "all": there is none behind a non-reflecting rear end, nor at the side in
  /// plane strain.
  [[nodiscard]] bool has_wall(const std::string& name) const;
  /// Key that gave that thickness: "walls.top" or "wall".
  [[nodiscard]] std::string wall_key(const std::string& name) const;
  /// The dimensions with the defaults of the kind filled in.
  [[nodiscard]] GeometryOptions resolved() const;
  /// Elements through a layer of this thickness [m]; `steel` layers have at least 2, or `wall_elements`.
  [[nodiscard]] int divisions(double thickness, bool steel) const;
  /// The same for any thickness, however many that is.
  [[nodiscard]] double layer_count(double thickness, bool steel) const;
  /// Number of elements that `make_mesh` would make.
  [[nodiscard]] double estimated_elements() const;
};

/// Divisions of a bar's section and length.
struct BarDivisions {
  double core, shell, along;
};
BarDivisions bar_divisions(const GeometryOptions& resolved);

/// Plan of the section of a jet-flow target: a wrap of layers around the nose and both legs, and a core within it.
/// Each list of counts belongs to the intervals between neighbouring entries of the list before it.
struct JetFlowPlan {
  std::vector<double> leg;  ///< x from the rear end to where the nose begins [m]
  std::vector<double> leg_counts;
  std::vector<double> angles;  ///< from where the nose begins, 0, to its tip, 90 [deg]
  std::vector<double> arc_counts;
  std::size_t corner = 0;                                   ///< the angle that ends at the core's corner
  double flat_count = 0;                                    ///< intervals on the flat front of a nose of less than half the height
  double wall = 0, channel = 0, plate = 0, transition = 0;  ///< layers of the wrap
  [[nodiscard]] double elements() const;
};
JetFlowPlan jet_flow_plan(const GeometryOptions& resolved);

}  // namespace calomel
