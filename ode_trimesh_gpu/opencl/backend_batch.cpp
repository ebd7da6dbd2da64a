// SPDX-License-Identifier: BSD-3-Clause
// Many pairs in one submission.
#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <memory>
#include <numeric>
#include <optional>

#include "collide/solid_contacts.h"
#include "collide/stages.h"
#include "opencl/backend_state.h"
#include "opencl/batch_source.h"
#include "opencl/stopwatch.h"
#include "opencl/take_records.h"

namespace otg::opencl {
/// One call for many pairs: what is left to the device goes there in pieces. `Finish` says what is made of a pair:
///   chunk(begin, count, found)      the flags (and contacts) of a piece, before anything else is said of its pairs
///   refuse(i)                       a pose that cannot be worked with
///   records(which, answer, query, recordsOf) pairs that the host has to finish: query(i), and places of its records
///                                   (there are none unless wantsRecords())
///   alone(i, query, onHost)         the pair is done without the batch; false if the device failed
template <class Source, class Finish>
class Backend::Batch {
 public:
  Batch(State& state, const Source& source, BatchWish wish, Finish& finish, LanePool<BatchLane>& lanes)
      : state_(state), source_(source), wish_(wish), finish_(finish), lanes_(lanes) {
    std::uint64_t largest = 0;
    for (const CollisionMesh* mesh : source.meshes) largest = std::max(largest, triangles(mesh));
    anyLarge_ = 2 * largest > state.tuning.batchTriangles;
  }

  /// False if the device failed.
  bool run(StageTimes* times) {
    times_ = times;
    const std::size_t most = std::max(1u, state_.tuning.batchPairs);
    // With times one after the other, so that each stage has the device for itself.
    const std::size_t pieces = times ? 1 : std::max(1u, state_.tuning.pieces);
    for (std::size_t at = 0; at < source_.size(); at += most) {
      const std::size_t end = std::min(source_.size(), at + most);
      submitFrom(at, end, std::max<std::size_t>(state_.tuning.leastPiece, (end - at + pieces - 1) / pieces));
    }
    return good_;
  }

 private:
  static constexpr otg_uint kNotDone = OTG_PAIR_REFUSED | OTG_PAIR_TO_HOST | OTG_PAIR_NO_FRAME | OTG_PAIR_SKIPPED;
  static std::uint64_t triangles(const CollisionMesh* mesh) { return mesh->mesh().triangleCount(); }

  /// The meshes of some pairs, when not all of a batch fit at once.
  void narrow(std::size_t begin, std::size_t count) {
    std::vector<std::uint32_t> number(source_.meshes.size(), kNone);
    meshes_.clear();
    const auto use = [&](std::uint32_t mesh) {
      if (number[mesh] != kNone) return;
      number[mesh] = static_cast<std::uint32_t>(meshes_.size());
      meshes_.push_back(source_.meshes[mesh]);
    };
    otg_batch_task task{};
    for (std::size_t i = begin; i < begin + count; ++i) {
      source_.fill(i, task);
      use(task.meshA);
      use(task.meshB);
    }
    renumber_ = std::move(number);
  }

  /// A part of the batch in one submission.
  struct Piece {
    std::size_t begin, count;
    std::unique_ptr<BatchLane> lane;  ///< none if it could not be begun
    std::uint64_t repeats = 0;        ///< of the lane until then
    std::vector<std::size_t> alone, large, refused;
    std::optional<ClError> error;
  };

  /// Pieces of `step` pairs: all are begun before the first is waited for, so that the host finishes what the device
  /// leaves of one while the device has the next.
  void submitFrom(std::size_t begin, std::size_t end, std::size_t step) {
    std::vector<Piece> pieces;
    for (std::size_t at = begin; at < end; at += step) pieces.push_back(begun(at, std::min(step, end - at), false));
    for (Piece& piece : pieces) finish(piece);
  }

  Piece begun(std::size_t begin, std::size_t count, bool part) {
    Piece piece{begin, count, nullptr, 0, {}, {}, {}, std::nullopt};
    if (part) {
      narrow(begin, count);
    } else if (meshes_.size() != source_.meshes.size()) {
      meshes_ = source_.meshes;
      renumber_.clear();
    }
    try {
      piece.lane = lanes_.take();
      piece.repeats = piece.lane->repeats();
      const Stopwatch watch(times_ != nullptr);
      const std::span<otg_batch_task> tasks = piece.lane->stage(count);
      fill(begin, tasks, piece.lane->stageFrames(), piece);
      if (times_) times_->fill += watch.ms();
      piece.lane->begin(meshes_, source_.reductions, wish_);
    } catch (const ClError& error) {
      piece.lane = nullptr;
      piece.error = error;
    }
    return piece;
  }

  void finish(Piece& piece) {
    const std::size_t begin = piece.begin, count = piece.count;
    // Nothing of a piece is finished before its last call of OpenCL: a failure leaves all of it.
    if (!piece.error) {
      try {
        const BatchFound found = piece.lane->end();
        if (times_) addTimes(piece.lane->profile());
        const Stopwatch collecting(times_ != nullptr);
        collect(piece, found);
        if (times_) times_->host += collecting.ms();
        lanes_.keep(std::move(piece.lane), piece.repeats);
      } catch (const ClError& error) {
        piece.lane = nullptr;
        piece.error = error;
      }
    }
    if (piece.error) {
      // Meshes that do not fit at once may fit in two halves.
      if (piece.error->code() == CL_MEM_OBJECT_ALLOCATION_FAILURE && count > 1) {
        Piece first = begun(begin, count / 2, true);
        finish(first);
        Piece second = begun(begin + count / 2, count - count / 2, true);
        finish(second);
        return;
      }
      logError(*piece.error);
      good_ = false;
      finish_.chunk(begin, count, {});
      for (std::size_t i = begin; i < begin + count; ++i) {
        const Query query = source_.query(i);
        if (isRefused(query)) {
          finish_.refuse(i);
        } else {
          finish_.alone(i, query, true);
        }
      }
      state_.onHost += count;
      return;
    }
    for (const std::size_t i : piece.alone) finish_.alone(i, source_.query(i), true);
    for (const std::size_t i : piece.large) good_ = finish_.alone(i, source_.query(i), false) && good_;
  }

  void fill(std::size_t begin, std::span<otg_batch_task> tasks, std::span<otg_batch_pair> frames, Piece& piece) {
    for (std::size_t k = 0; k < tasks.size(); ++k) source_.fill(begin + k, tasks[k]);
    if (!renumber_.empty()) {
      for (otg_batch_task& task : tasks) {
        task.meshA = renumber_[task.meshA];
        task.meshB = renumber_[task.meshB];
      }
    }
    if (anyLarge_) {
      for (std::size_t k = 0; k < tasks.size(); ++k) {
        const CollisionMesh *a = meshes_[tasks[k].meshA], *b = meshes_[tasks[k].meshB];
        if (triangles(a) + triangles(b) <= state_.tuning.batchTriangles) continue;
        tasks[k].skip = 1;
        (isRefused(source_.query(begin + k)) ? piece.refused : piece.large).push_back(begin + k);
      }
    }
    for (std::size_t k = 0; k < frames.size(); ++k) {
      if (tasks[k].skip) continue;
      const Query query = source_.query(begin + k);
      const PairFrame frame = makePairFrame(query);
      if (isRefused(query) || isIdleQuery(query, frame)) {
        (isRefused(query) ? piece.refused : piece.alone).push_back(begin + k);
        tasks[k].skip = 1;
        continue;
      }
      const BoxFrame<float> boxes = deviceBoxes(frame);
      std::copy(std::begin(boxes.r), std::end(boxes.r), frames[k].r);
      frames[k].t = boxes.t;
      frames[k].eps = boxes.eps;
      frames[k].delta = frame.floatError.delta;
      frames[k].meshA = tasks[k].meshA;
      frames[k].meshB = tasks[k].meshB;
    }
  }

  void collect(Piece& piece, const BatchFound& found) {
    const std::size_t begin = piece.begin, count = piece.count;
    std::vector<std::size_t> fromRecords;
    const bool all = wish_ == BatchWish::kPairs;
    bool scattered = false;
    if (all || wish_ == BatchWish::kAny || found.counters[OTG_COUNT_FLAGGED] > 0) {
      for (std::size_t k = 0; k < count; ++k) {
        const otg_uint flags = found.flags[k];
        if (flags & OTG_PAIR_REFUSED) {
          piece.refused.push_back(begin + k);
        } else if (flags & OTG_PAIR_NO_FRAME) {
          piece.alone.push_back(begin + k);
        } else if (flags & OTG_PAIR_SKIPPED) {
          continue;
        } else if (all || ((flags & OTG_PAIR_TO_HOST) && !(flags & OTG_PAIR_INTERSECTS))) {
          fromRecords.push_back(begin + k);
          scattered = scattered || (flags & OTG_PAIR_MANY);
        }
      }
    }
    if (!fromRecords.empty() && !finish_.wantsRecords()) {
      finish_.chunk(begin, count, found);
      finish_.records(
          fromRecords, Answer{}, [&](std::size_t i) { return source_.query(i); },
          [](std::size_t) { return std::span<const std::uint32_t>(); });
    } else if (!fromRecords.empty()) {
      // The counters and contacts of `found` stay where they are meanwhile.
      const Answer answer = scattered ? piece.lane->records() : piece.lane->recordsLeft();
      finish_.chunk(begin, count, found);
      dealOut(begin, count, answer, fromRecords);
    } else {
      finish_.chunk(begin, count, found);
    }
    if (wish_ == BatchWish::kSolid && source_.anyHistory) {
      for (std::size_t k = 0; k < count; ++k) {
        if ((found.flags[k] & (kNotDone | OTG_PAIR_PAIRWISE)) == 0) rememberPlain(source_.query(begin + k));
      }
    }
    for (const std::size_t i : piece.refused) finish_.refuse(i);
  }

  /// Gives each of `which` its records.
  void dealOut(std::size_t begin, std::size_t count, const Answer& answer, const std::vector<std::size_t>& which) {
    std::vector<std::uint32_t> from(count + 1, 0), records(answer.count);
    for (std::uint32_t r = 0; r < answer.count; ++r) ++from[pairOfRecord(answer, r) + 1];
    std::partial_sum(from.begin(), from.end(), from.begin());
    std::vector<std::uint32_t> next(from.begin(), from.end() - 1);
    for (std::uint32_t r = 0; r < answer.count; ++r) records[next[pairOfRecord(answer, r)]++] = r;
    finish_.records(
        which, answer, [&](std::size_t i) { return source_.query(i); },
        [&](std::size_t i) {
          const std::size_t k = i - begin;
          return std::span<const std::uint32_t>(records).subspan(from[k], from[k + 1] - from[k]);
        });
  }

  void addTimes(const Profile& profile) {
    times_->write += profile.ms(Profile::kWrite);
    times_->top += profile.ms(Profile::kTop);
    times_->main += profile.ms(Profile::kMain);
    times_->contacts += profile.ms(Profile::kContacts);
    times_->regions += profile.ms(Profile::kRegions);
    times_->select += profile.ms(Profile::kSelect);
    times_->choose += profile.ms(Profile::kChoose);
    times_->readBack += profile.ms(Profile::kReadBack);
  }

  State& state_;
  const Source& source_;
  const BatchWish wish_;
  Finish& finish_;
  LanePool<BatchLane>& lanes_;
  bool good_ = true, anyLarge_ = false;
  std::vector<const CollisionMesh*> meshes_;  ///< of the submission under way
  std::vector<std::uint32_t> renumber_;       ///< from the source's numbers to these; empty: the same
  StageTimes* times_ = nullptr;
};

namespace {

void addStats(CollideStats& sums, const CollideStats& s) {
  sums.boxTests += s.boxTests;
  sums.candidatePairs += s.candidatePairs;
  sums.decidedByDouble += s.decidedByDouble;
  sums.intersectingPairs += s.intersectingPairs;
  sums.decidedExactly += s.decidedExactly;
  sums.contactsBeforeReduction += s.contactsBeforeReduction;
}

/// Contacts of pairs, most of them where the device put them.
struct ContactFinish {
  Backend& backend;
  std::atomic<std::uint64_t>& queries;
  BatchAnswer& answer;
  Workspace workspace{};
  std::vector<std::size_t>* left = nullptr;  ///< where pairs are listed that are the host's; null: they are done here
  const RunParts* onHost = nullptr;          ///< by this, if it is there

  void chunk(std::size_t begin, std::size_t count, const BatchFound& found) {
    answer.addQueries(count);
    for (const BatchFound::Contacts& part : found.contacts) {
      answer.addPart(begin, count, part.places, part.contacts, part.memory);
    }
    if (found.counters == nullptr) return;
    CollideStats device;
    const Answer counted{found.counters, nullptr, 0, 0};
    takeCounts(counted, device);
    device.intersectingPairs = found.counters[OTG_COUNT_INTERSECTING];
    device.contactsBeforeReduction = found.counters[OTG_COUNT_CONTACTS];
    addStats(answer.stats, device);
  }

  void refuse(std::size_t i) { answer.refused.push_back(i); }
  bool wantsRecords() const { return left == nullptr; }

  template <class QueryOf, class RecordsOf>
  void records(const std::vector<std::size_t>& which, const Answer& found, const QueryOf& queryOf,
               const RecordsOf& recordsOf) {
    answer.leftToHost += which.size();
    if (left) {
      left->insert(left->end(), which.begin(), which.end());
    } else if (onHost && which.size() > 1) {
      struct Done {
        std::vector<Contact> contacts;
        CollideStats stats;
      };
      std::vector<Done> done(which.size());
      (*onHost)(which.size(), [&](std::size_t begin, std::size_t end) {
        Workspace own;
        for (std::size_t k = begin; k < end; ++k) {
          collideFromRecords(queryOf(which[k]), found, recordsOf(which[k]), own);
          done[k] = {own.reduced, own.stats};
        }
      });
      for (std::size_t k = 0; k < which.size(); ++k) keep(which[k], done[k].stats, done[k].contacts);
    } else {
      for (const std::size_t i : which) {
        collideFromRecords(queryOf(i), found, recordsOf(i), workspace);
        keep(i, workspace.stats, workspace.reduced);
      }
    }
  }

  bool alone(std::size_t i, const Query& query, bool onHost) {
    bool good = true;
    if (onHost && left) {
      left->push_back(i);
      return true;
    }
    if (onHost) {
      collide(query, workspace);
    } else {
      --queries;  // counted again there
      good = backend.collide(query, workspace);
    }
    keep(i, workspace.stats, workspace.reduced);
    return good;
  }

  void keep(std::size_t i, const CollideStats& stats, const std::vector<Contact>& contacts) {
    addStats(answer.stats, stats);
    if (!contacts.empty()) answer.add(i, contacts);
  }

  void end() { std::sort(answer.refused.begin(), answer.refused.end()); }
};

/// Yes or no.
struct AnyFinish {
  Backend& backend;
  std::atomic<std::uint64_t>& queries;
  std::vector<std::uint8_t>& answer;
  Workspace workspace{};

  void chunk(std::size_t begin, std::size_t count, const BatchFound& found) {
    if (found.flags == nullptr) return;
    for (std::size_t k = 0; k < count; ++k) answer[begin + k] = (found.flags[k] & OTG_PAIR_INTERSECTS) != 0;
  }
  void refuse(std::size_t) {}
  static bool wantsRecords() { return true; }
  template <class QueryOf, class RecordsOf>
  void records(const std::vector<std::size_t>& which, const Answer& found, const QueryOf& queryOf,
               const RecordsOf& recordsOf) {
    for (const std::size_t i : which) {
      const Query query = queryOf(i);
      const PairFrame frame = makePairFrame(query);
      const std::span<const std::uint32_t> some = recordsOf(i);
      answer[i] = std::any_of(some.begin(), some.end(),
                              [&](std::uint32_t r) { return recordIntersects(query, frame, found, r); });
    }
  }
  bool alone(std::size_t i, const Query& query, bool onHost) {
    bool good = true;
    if (onHost) {
      findIntersectingPairs(query, workspace);
    } else {
      --queries;  // counted again there
      good = backend.findIntersectingPairs(query, workspace);
    }
    answer[i] = !workspace.intersecting.empty();
    return good;
  }
};

}  // namespace

template <class Source>
bool Backend::collideFrom(const Source& source, BatchAnswer& answer, StageTimes* times, std::vector<std::size_t>* left,
                          const RunParts& onHost) {
  const Stopwatch total(times != nullptr);
  if (times) *times = {};
  state_->queries += source.size();
  answer.clear();
  ContactFinish finish{*this, state_->queries, answer};
  finish.left = left;
  if (onHost) finish.onHost = &onHost;
  LanePool<BatchLane>& lanes = times ? state_->profiledBatches : state_->batches;
  const BatchWish wish = !state_->reduces()                        ? BatchWish::kPairs
                         : source.anySolid && state_->tuning.solid ? BatchWish::kSolid
                         : source.anyPairwise                      ? BatchWish::kContacts
                                                                   : BatchWish::kPairs;
  Batch<Source, ContactFinish> batch(*state_, source, wish, finish, lanes);
  const bool good = batch.run(times);
  finish.end();
  if (times) times->total = total.ms();
  return good;
}

template <class Source>
bool Backend::intersectFrom(const Source& source, std::vector<std::uint8_t>& answer, StageTimes* times) {
  const Stopwatch total(times != nullptr);
  if (times) *times = {};
  state_->queries += source.size();
  answer.assign(source.size(), 0);
  AnyFinish finish{*this, state_->queries, answer};
  LanePool<BatchLane>& lanes = times ? state_->profiledBatches : state_->batches;
  Batch<Source, AnyFinish> batch(*state_, source, BatchWish::kAny, finish, lanes);
  const bool good = batch.run(times);
  if (times) times->total = total.ms();
  return good;
}

bool Backend::collideBatch(std::span<const Query> queries, BatchAnswer& answer, StageTimes* times,
                           std::vector<std::size_t>* left) {
  return collideFrom(QuerySource(queries, state_->tuning.solid), answer, times, left, {});
}

bool Backend::collideBatch(const PairBatch& batch, BatchAnswer& answer, StageTimes* times, const RunParts& onHost) {
  return collideFrom(PairSource(batch, state_->tuning.solid), answer, times, nullptr, onHost);
}

bool Backend::intersectBatch(std::span<const Query> queries, std::vector<std::uint8_t>& answer, StageTimes* times) {
  return intersectFrom(QuerySource(queries, state_->tuning.solid), answer, times);
}

bool Backend::intersectBatch(const PairBatch& batch, std::vector<std::uint8_t>& answer, StageTimes* times) {
  return intersectFrom(PairSource(batch, state_->tuning.solid), answer, times);
}

}  // namespace otg::opencl
