// Are a model's paths farther from people's than those are from each other?
//
// Each distance between two paths is either between a model and a person, or between two persons.
// The statistic is the chance that one of the first kind exceeds one of the second (ties half): 0.5
// where the model walks like one more person, 1 where every person is nearer to every other than to
// the model. It is the U of Mann and Whitney (Ann. Math. Stat. 18, 1947) over the number of
// comparisons, the common language effect size of McGraw and Wong (Psych. Bulletin 111, 1992).
// Ranks, because a person who got lost must not decide the matter.
//
// Two p-values, both one-sided:
//
// - `p`, sound: were the model a person, the label "model" could as well stand on any other path.
// So
//   the labels are permuted, and p is the share of labellings whose statistic is as large as the
//   true one. The distances stay as they are, so it does not matter that they depend on each other.
//   It cannot be smaller than one over the number of labellings: one path of a model beside ten
//   people gives 1/11 at best; run the model from several starts, or record more people.
// - `pairsP`, the Mann-Whitney test (normal, with corrections for continuity and ties), which takes
// the
//   distances for independent. They are not, so it is too sure of itself. It is here because it is
//   what is published: .023, .045 and .28 for the tables of Ono's thesis.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "agents/evaluation/distance_table.h"

namespace forewalk::agents {

struct SeparationSettings {
  std::size_t draws =
      10'000;              ///< labellings to look at: all where there are no more, else a sample
  std::uint64_t seed = 1;  ///< of the sample
};

struct Separation {
  double superiority = 0.5;    ///< P(model to person > person to person) + half P(equal)
  double p = 1.0;              ///< labels permuted
  double leastP = 1.0;         ///< the smallest that p could have been
  std::size_t labellings = 0;  ///< that were looked at
  bool exact = false;          ///< these are all there are
  double pairsP = 1.0;         ///< distances taken for independent
};

/// Distances within `model` and to paths in neither list play no part. Of a sample, p counts the
/// true labelling too, so that it is never 0 (Phipson and Smyth, Stat. Appl. Genet. Mol. Biol. 9,
/// 2010).
///
/// REQUIRES: `people` has two paths or more, `model` one, none in both or twice. Costs O(labellings
/// * pairs).
Separation separation(const DistanceTable& table, std::span<const std::size_t> people,
                      std::span<const std::size_t> model, const SeparationSettings& settings = {});

}  // namespace forewalk::agents
