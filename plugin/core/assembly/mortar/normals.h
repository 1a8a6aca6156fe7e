#pragma once
#include "assembly/mortar/cover.h"

namespace frictioncg::mortar {

/// A held part of a unit vector up to this length is none. That of a normal is projected away;
/// beyond it the node carries no law.
constexpr Real mostly_free = 0.02;
Vec3 held_part(const Nodes& nodes, Index i, const Vec3& direction);
/// Whether node i can have a law along a normal: no obstacle takes it, and no Dirichlet condition
/// holds that.
bool can_press(const Nodes& nodes, Index i, const Vec3& normal);

/// Whether facet f of the slave of pair p belongs to the patch that owns node i.
using Owns = std::function<bool(std::size_t p, Index f, Index i)>;

/// Which motions a slave's normals let slip, by pair and body; none, by body -1, where all of the
/// slave is flat.
using Slipping = std::map<std::array<Index, 2>, Slips>;

/// The normals of the laws, per node: of the smooth surface of the owning patch, where several of
/// its surfaces meet their mean; 0 where none owns the node. Motions that keep a body's slave in
/// contact, as far as the mesh can tell, do so exactly (slippable.h).   slipping: as far as it is
/// decided; the rest is added.
std::vector<Vec3> slave_normals(const Sides& of, const Options& options, const Owns& owns,
                                Slipping& slipping);

using TwoBodies = std::pair<Index, Index>;  ///< of slave and master

struct FacetShape {
  bool flat = false, bore = false;
};
/// Per facet; empty where no facet differs from what may be before it.
struct PairShapes {
  std::vector<FacetShape> slave, master;
  std::set<TwoBodies> chamfered;
  /// Where some are: of the slave chamfers, of the master what is in the plane that they keep off.
  std::vector<char> leaning, level;
  bool at_chamfer(Index f, Index m, const TwoBodies& bodies) const {
    return chamfered.count(bodies) > 0 && leaning[f] && level[m];
  }
};

/// Where the normals of masters count.
struct CommonNormals {
  struct Choice {
    bool master = false;
    /// Which motions the normals that count let slip: of all, where they are the master's, and
    /// of those that A leaves free.
    Slips motions, free;
  };
  explicit CommonNormals(std::size_t nodes) : of_master(nodes, 0), turns(nodes, 0) {}

  std::vector<char> of_master;                    ///< per node
  std::vector<char> turns;                        ///< as one with what it faces, if need be
  std::map<std::array<Index, 3>, Choice> choice;  ///< by pair, and by the bodies of both sides
  std::vector<PairShapes> shapes;                 ///< per pair
};

/// Where a curved face is before a flat one, the normals are those of either: a disc of radius R
/// touches a flat, points are matched once, and action is reaction. With normals that turn by b x a
/// slip a and a rotation w about the contact change the gap by x (w - b a). What is exact to second
/// order, w (w - a/R) R/2, has two motions without change: sliding along the flat (w = 0) and
/// turning of the disc (w = a/R). One choice, b = 0 or 1/R, leaves one of them free, any other
/// neither.
///
/// The normals are those of the side that lets more of what A leaves free slip, or whose motions A
/// resists less, clearly; where supports hold all of them the slave's, and otherwise those of the
/// flat: what slides along it moves further than what turns on it. But for supports the answer so
/// does not depend on which side is slave. A shaft in a bore, with clearance, is alike: along the
/// bore it does not leave its place for ever but climbs, and the shaft's own normals see that; so
/// of a bore and what is in it the latter counts.
///
/// A chamfer beside a face that lies on a flat, which keeps it off that plane, has the flat's
/// normals, whatever is free: along its own it would wedge what slides. What leans nearer than the
/// faces that lie, or on something else, is a wedge, and keeps its own.
///
/// normal: of the slave's own surface, per node, replaced where the master's count; owns: as in
/// slave_normals; begun: where the increment began, which has decided; null: it is decided here.
/// Faces of one body keep theirs. What A leaves free, and the normals that count let slip as far as
/// the mesh can tell, they let slip to rounding (slippable.h).
CommonNormals choose_common_normals(const Sides& of, const Options& options, const Owns& owns,
                                    const CommonNormals* begun, std::vector<Vec3>& normal);

/// At the end of a face of the slave, a rim or a ridge that juts out, it is the edge that touches
/// where the face leans on it: a block on its corner presses along the normal of what is below,
/// without friction, however it leans. A node there that is before a master has
///
///   n ~ (m.n_s) n_s + s P_C (m - (m.n_s) n_s)
///
/// m: minus the normal of the master's smooth surface before it; C: the cone of the directions that
/// leave the face there, but for those that supports hold: on a plane of symmetry it goes on. So it
/// keeps n_s, which the others have, where the gap does not open into the face. s is 1 where the
/// lean is clear and what the facet is before leans as a whole; it fades to 0 where bodies deform
/// by as much, where smooth faces turn by half as much from facet to facet, and where the facet
/// lies on what does not lean: at the foot of a wall.
void take_masters_at_ends(const Sides& of, const Owns& owns, std::vector<Vec3>& normal,
                          std::vector<char>& of_master);

}  // namespace frictioncg::mortar
