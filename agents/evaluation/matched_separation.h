// Is a model farther from people than they are from each other, where it walked in their place? And
// are its paths told apart from theirs at all?
//
// A recorded leg begins and ends where its walker did. A model that is sent from that very start to
// that very goal shares both with this one person and with nobody else, so its path may not be
// compared with theirs, and of the labels "person" and "model" only those two may be swapped. Were
// the model one more person, each of the two paths of a leg could as well be the recorded one: the
// labels are flipped leg by leg, and p is the share of labellings that look as extreme
// (randomisation within pairs, Fisher, The Design of Experiments, 1935). Two statistics:
//
// - the superiority of separation.h: how often a distance from one person to another's model
//   exceeds one from person to person;
// - the energy distance (Szekely and Rizzo, J. Stat. Planning and Inference 143, 2013): twice the
//   mean distance across, less the mean ones among people and among models. It also sees a model
//   that walks in the middle of all: nearer to everybody than they are to each other, and always
//   the same.
//
// Several sets of legs (between other places) are looked at together: a person who walks in
// several is flipped in all of them at once, since who walks wide here walks wide there.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "agents/evaluation/distance_table.h"
#include "agents/evaluation/separation.h"

namespace forewalk::agents {

/// The legs of one set: path `people[k]` of the table is that of person `walkers[k]`, and
/// `models[k]` the model's from the same start to the same goal.
struct MatchedLegs {
  const DistanceTable* table;
  std::vector<std::size_t> people, models;
  std::vector<std::size_t> walkers;  ///< numbers of persons, the same for a person in every set
};

struct MatchedSeparation {
  /// P(person to another's model > person to person) + half P(equal), in each set; then the mean
  /// over sets, weighted by their legs.
  double superiority = 0.5;
  double farther = 1.0;  ///< p: the share of labellings with a superiority as large
  /// Over the mean of all distances of a set (between different legs); then as above. About 0 for
  /// one more person, 2 at most.
  double energy = 0.0;
  double apart = 1.0;   ///< p: the share with an energy distance as large
  double leastP = 1.0;  ///< the smallest that either could have been; twice that is usual: with all
                        ///< labels swapped two groups are as far apart as before
  std::size_t labellings = 0;  ///< that were looked at
  bool exact = false;          ///< these are all there are: 2 for every person
};

/// Distances within a leg play no part. Of a sample the true labelling is counted too. The order of
/// sets and legs does not matter, but for rounding.
///
/// REQUIRES: a set or more, each with two legs or more, of different walkers; lists of one length;
/// indices in the table. Costs O(labellings * legs^2 log legs).
MatchedSeparation matchedSeparation(std::span<const MatchedLegs> sets,
                                    const SeparationSettings& settings = {});

}  // namespace forewalk::agents
