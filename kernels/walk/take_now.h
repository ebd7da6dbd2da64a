// SPDX-License-Identifier: BSD-3-Clause
// What the last work-group of a kernel reads of words that all others have counted in.
#ifndef OTG_TAKE_NOW_H
#define OTG_TAKE_NOW_H

/// What a word holds that other work-groups of this kernel have changed by atomics; zero then. A plain read may see a
/// line that this compute unit has read before they did.
inline static uint otgTakeNow(volatile __global uint* word) {
  return atomic_xchg(word, 0);  // unordered: by the last, to which all others have reported that they are done
}

/// The same, but for the word, which stays.
inline static uint otgReadNow(volatile __global uint* word) {
  return atomic_or(word, 0);
}

#endif  // OTG_TAKE_NOW_H
