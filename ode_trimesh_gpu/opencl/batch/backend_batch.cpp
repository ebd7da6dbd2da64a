// SPDX-License-Identifier: BSD-3-Clause
// Many pairs in one submission.
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <thread>
#include <unordered_map>

#include "collide/pair_history.h"
#include "collide/shell/shell_roles.h"
#include "collide/solid/look_ahead.h"
#include "collide/solid/solid_contacts.h"
#include "opencl/backend.h"
#include "opencl/backend_state.h"
#include "opencl/batch/batch_finish.h"
#include "opencl/batch/batch_source.h"
#include "opencl/batch/piece_under_way.h"
#include "opencl/batch/pieces.h"
#include "opencl/batch/routing.h"
#include "opencl/lanes/host_cases.h"
#include "opencl/lanes/overlap_queue.h"
#include "opencl/lanes/take_times.h"
#include "opencl/runtime/stopwatch.h"

namespace otg::opencl {

/// One call for many pairs: what is left to the device goes there in pieces. `Finish` says what is made of a pair:
///   meanwhile(which, query)         what the CPU makes of pairs that the device will leave, while it is at work
///   keepLeft(i, done)               one of these
///   chunk(begin, count, found)      the flags (and contacts) of a piece, before anything else is said of its pairs
///   refuse(i)                       a pose that cannot be worked with
///   records(which, answer, query, recordsOf) pairs that the CPU has to finish: query(i), and places of its records
///   described(which, query, found)  pairs whose overlaps are described, and for each of them the description; those
///                                   for which it is of no use are returned (if kTakesDescriptions)
///   alone(i, query)                 a pair too large for one work-group is done without the batch (if kLargeAlone);
///                                   false if the device failed
///   withoutDevice(which, query)     pairs that the device has no part in
///   lookAhead(which, query)         pairs whose contacts the device made, and which may meet more on their way; false
///                                   if the device failed (if kTakesDescriptions)
///   settle(which, query)            such pairs: contacts that contradict or are too deep (if kTakesDescriptions)
template <class Source, class Finish>
class Backend::Batch {
 public:
  Batch(BackendState& state, const Source& source, BatchRequest request, Finish& finish, bool profile)
      : state_(state),
        source_(source),
        request_(request),
        finish_(finish),
        lanes_(profile ? state.profiledBatches : state.batches),
        rules_{.recordsOfAll = request == BatchRequest::kPairs,
               .describes = Finish::kTakesDescriptions && request == BatchRequest::kSolid &&
                            LargeStage::works(state.context, state.tuning)},
        overlaps_(profile ? state.profiledOverlaps : state.overlaps, state.tuning.overlapPairs) {
    for (const CollisionMesh* mesh : source.meshes) largest_ = std::max(largest_, triangles(mesh));
    anyLarge_ = Finish::kLargeAlone && 2 * largest_ > state.tuning.batchTriangles;
    hasContactsOfHost_ =
        Finish::kTakesDescriptions &&
        (source.anyConvexPath || std::any_of(source.meshes.begin(), source.meshes.end(), mayBeForHost));
    mayMeetAhead_ = Finish::kTakesDescriptions && request == BatchRequest::kSolid &&
                    std::any_of(source.meshes.begin(), source.meshes.end(), isCornered);
  }

  /// False if the device failed.
  bool run(StageTimes* times) {
    times_ = times;
    std::vector<std::vector<PairRange>> submissions = cutBatch(source_.size(), state_.tuning, times != nullptr);
    if (mayBeLong()) submissions = cutPieces(submissions, works(), state_.tuning);
    for (const std::vector<PairRange>& pieces : submissions) submit(pieces);
    finish();
    return good_;
  }

 private:
  static constexpr std::size_t kMostWaits = 500;  ///< of a batch, for memory, a millisecond each
  static std::uint64_t triangles(const CollisionMesh* mesh) { return mesh->mesh().triangleCount(); }
  /// Whether launches may be too long if only pairs are counted. A first hit is soon found.
  bool mayBeLong() const {
    const std::size_t pairs = std::min<std::size_t>(source_.size(), state_.tuning.batchPairs);
    return request_ != BatchRequest::kAny &&
           2.0 * static_cast<double>(largest_) * static_cast<double>(pairs) > state_.tuning.batchWork;
  }
  /// Of each pair: twice the triangles of the smaller mesh, since what meets grows with that, and the trees leave out
  /// the rest of the larger one. Those that are too large for a batch do not count.
  std::vector<double> works() const {
    std::vector<double> out(source_.size());
    otg_batch_task task{};
    for (std::size_t i = 0; i < out.size(); ++i) {
      source_.fill(i, task);
      const std::uint64_t a = triangles(source_.meshes[task.meshA]), b = triangles(source_.meshes[task.meshB]);
      const bool isAlone = a + b > state_.tuning.batchTriangles && Finish::kLargeAlone;
      out[i] = isAlone ? 1 : 2.0 * static_cast<double>(std::min(a, b));
    }
    return out;
  }

  /// The meshes of some pairs, when not all of a batch fit at once.
  void narrow(const PairRange& range) {
    meshes_.clear(source_.meshes.size());
    otg_batch_task task{};
    for (std::size_t i = range.begin; i < range.begin + range.count; ++i) {
      source_.fill(i, task);
      meshes_.use(source_.meshes, task.meshA);
      meshes_.use(source_.meshes, task.meshB);
    }
  }

  void submit(std::span<const PairRange> ranges) {
    std::vector<PieceUnderWay> pieces;
    for (const PairRange& range : ranges) pieces.push_back(begun(range, false));
    workMeanwhile(pieces);
    for (PieceUnderWay& piece : pieces) finish(piece);
    finishOverlaps();
    withoutDevice(later_);
    later_.clear();
  }

  PieceUnderWay begun(const PairRange& range, bool part) {
    const auto [begin, count] = range;
    PieceUnderWay piece{begin, count};
    if (part) {
      narrow(range);
    } else {
      meshes_.takeAll(source_.meshes);
    }
    try {
      piece.lane = lanes_.take();
      piece.repeats = piece.lane->repeats();
      const Stopwatch watch(times_ != nullptr);
      const std::span<otg_batch_task> tasks = piece.lane->stage(count);
      fill(begin, tasks, piece.lane->stageFrames(), piece);
      fillDirections(begin, *piece.lane);
      if (times_) times_->fill += watch.ms();
      piece.soon = asksSoon();
      if (piece.soon) {
        piece.lane->beginWithFlags(meshes_.list(), source_.reductions, finish_.onHost);
      } else {
        piece.lane->begin(meshes_.list(), source_.reductions, request_, finish_.onHost);
      }
    } catch (const ClError& error) {
      piece.lane = nullptr;
      piece.error = error;
      piece.lacksMemory = dynamic_cast<const MemoryInUse*>(&error) != nullptr;
    }
    return piece;
  }

  void finish(PieceUnderWay& piece) {
    const std::size_t begin = piece.begin, count = piece.count;
    // Nothing of a piece is finished before its last call of OpenCL: a failure leaves all of it.
    if (!piece.error) {
      try {
        const BatchFound found = piece.lane->end();
        if (times_) addTimes(*times_, piece.lane->profile());
        const Stopwatch collecting(times_ != nullptr);
        collect(piece, found);
        if (times_) times_->host += collecting.ms();
        if (piece.lane) letGo(std::move(piece.lane), piece.repeats);
      } catch (const ClError& error) {
        piece.lane = nullptr;
        piece.error = error;
      }
    }
    if (piece.error) {
      // Meshes that do not fit at once may fit in two halves.
      if (piece.error->code() == CL_MEM_OBJECT_ALLOCATION_FAILURE && count > 1) {
        for (const PairRange& half : halvesOf({begin, count})) {
          finishOverlaps();  // they have meshes pinned
          finishHalf(half);
        }
        return;
      }
      logError(*piece.error);
      good_ = false;
      finish_.chunk(begin, count, {});
      std::vector<std::size_t> good;
      for (std::size_t i = begin; i < begin + count; ++i) {
        const Fate fate = fateAfterFailure(isRefused(source_.query(i)), done_.contains(i));
        if (fate == Fate::kRefused) finish_.refuse(i);
        if (fate == Fate::kMeanwhile) keepMeanwhile(i);
        if (fate == Fate::kWithoutDevice) good.push_back(i);
      }
      withoutDevice(good);
      state_.onHost += count;
      return;
    }
    withoutDevice(piece.alone);
    if constexpr (Finish::kLargeAlone) {
      for (const std::size_t i : piece.large) good_ = finish_.alone(i, source_.query(i)) && good_;
    }
  }

  void finishHalf(const PairRange& range) {
    PieceUnderWay piece = begun(range, true);
    // Others are done soon; but the memory may be this batch's own.
    for (; range.count == 1 && piece.lacksMemory && waits_ < kMostWaits; ++waits_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      piece = begun(range, true);
    }
    workMeanwhile({&piece, 1});
    finish(piece);
  }

  void fill(std::size_t begin, std::span<otg_batch_task> tasks, std::span<otg_batch_pair> frames,
            PieceUnderWay& piece) {
    const auto copy = [&](std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) source_.fill(begin + k, tasks[k]);
    };
    Source::kIsScattered ? finish_.inParts(tasks.size(), copy) : copy(0, tasks.size());
    meshes_.renumber(tasks);
    const auto leaveOut = [&](std::size_t k, Fate fate) {
      tasks[k].skip = 1;
      (fate == Fate::kRefused ? piece.refused : fate == Fate::kAlone ? piece.large : piece.alone).push_back(begin + k);
    };
    if (anyLarge_) {
      const std::vector<const CollisionMesh*>& meshes = meshes_.list();
      for (std::size_t k = 0; k < tasks.size(); ++k) {
        const CollisionMesh *a = meshes[tasks[k].meshA], *b = meshes[tasks[k].meshB];
        if (triangles(a) + triangles(b) <= state_.tuning.batchTriangles) continue;
        leaveOut(k, fateBefore({.refused = isRefused(source_.query(begin + k)), .large = true}));
      }
    }
    if (hasContactsOfHost_) {
      std::vector<std::uint8_t> isHosts(tasks.size(), 0);
      finish_.inParts(tasks.size(), [&](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k) isHosts[k] = !tasks[k].skip && isForHost(source_.query(begin + k));
      });
      for (std::size_t k = 0; k < tasks.size(); ++k) {
        if (isHosts[k]) leaveOut(k, fateBefore({.refused = isRefused(source_.query(begin + k)), .host = true}));
      }
    }
    for (std::size_t k = 0; k < frames.size(); ++k) {
      if (tasks[k].skip) continue;
      const Query query = source_.query(begin + k);
      const PairFrame frame = makePairFrame(query);
      const Fate fate = fateBefore({.refused = isRefused(query), .idle = isIdleQuery(query, frame)});
      if (fate != Fate::kDevice) {
        leaveOut(k, fate);
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

  /// What pairs remember of their last deep regions.
  void fillDirections(std::size_t begin, BatchLane& lane) {
    if constexpr (Finish::kTakesDescriptions) {
      if (request_ != BatchRequest::kSolid || !source_.anyHistory) return;
      const std::span<Vec3d> directions = lane.stageDirections();
      finish_.inParts(directions.size(), [&](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k) directions[k] = deepDirectionBefore(source_.query(begin + k));
      });
    }
  }

  bool asksSoon() const {
    if constexpr (Finish::kTakesDescriptions) {
      return request_ == BatchRequest::kSolid && finish_.hasThreads() && state_.tuning.meanwhile > 0;
    }
    return false;
  }

  /// Some pairs that are left to the CPU as soon as that is known, piece by piece, while the device goes on. Where
  /// they are many, their records are waited for, which show the CPU what intersects; or they are described.
  void workMeanwhile(std::span<PieceUnderWay> pieces) {
    if constexpr (Finish::kTakesDescriptions) {
      for (PieceUnderWay& piece : pieces) {
        if (!piece.soon || piece.error) continue;
        try {
          const std::vector<std::size_t> which = leftSoon(piece);
          if (which.empty()) continue;
          auto done = finish_.meanwhile(which, [&](std::size_t i) { return source_.query(i); });
          for (std::size_t k = 0; k < which.size(); ++k) done_.emplace(which[k], std::move(done[k]));
        } catch (const ClError& error) {
          piece.lane = nullptr;
          piece.error = error;
        }
      }
    }
  }

  /// Which pairs of a piece the CPU is to do at once.
  std::vector<std::size_t> leftSoon(PieceUnderWay& piece) {
    const otg_uint* flags = piece.lane->soonFlags();
    std::vector<std::size_t> which;
    std::size_t describable = 0, left = 0;
    for (std::size_t k = 0; k < piece.count; ++k) {
      if (!isLeftEarly(flags[k])) continue;
      ++left;
      describable += rules_.describes && mayBeDescribed(flags[k]);
      if (!done_.contains(piece.begin + k)) which.push_back(piece.begin + k);
    }
    const Tuning& tuning = state_.tuning;
    if (!isForHostMeanwhile(left, describable, tuning.meanwhile, tuning.leastOverlaps)) which.clear();
    return which;
  }

  /// What the CPU has made of pair `i` while the device was at work.
  void keepMeanwhile(std::size_t i) {
    if constexpr (Finish::kTakesDescriptions) finish_.keepLeft(i, done_.at(i));
  }

  void collect(PieceUnderWay& piece, const BatchFound& found) {
    const std::size_t begin = piece.begin, count = piece.count;
    std::vector<std::size_t> fromRecords, fromMeanwhile;
    OverlapSubmission job;
    bool scattered = false, makes = true;  // contacts from descriptions
    if (rules_.recordsOfAll || request_ == BatchRequest::kAny || found.counters[OTG_COUNT_FLAGGED] > 0) {
      for (std::size_t k = 0; k < count; ++k) {
        const otg_uint flags = found.flags[k];
        if ((flags & kNotByDevice) == 0 && !rules_.recordsOfAll) continue;  // as nearly all
        const std::size_t i = begin + k;
        const Fate fate = fateAfter(flags, rules_, done_.contains(i));
        if (fate == Fate::kRefused) piece.refused.push_back(i);
        if (fate == Fate::kWithoutDevice) piece.alone.push_back(i);
        if (fate == Fate::kMeanwhile) fromMeanwhile.push_back(i);
        if (fate == Fate::kRecords) fromRecords.push_back(i);
        if (fate == Fate::kDescribed) {
          const Query query = source_.query(i);
          job.add(i, {static_cast<otg_uint>(k), found.contacts[0].places[2 * k], 0, 0, 0}, query.a, query.b);
          makes = makes && LargeContacts::works(query, state_.tuning);
        }
        const bool needsRecords = fate == Fate::kRecords || fate == Fate::kDescribed;
        scattered = scattered || (needsRecords && (flags & OTG_PAIR_MANY));
      }
    }
    if (!areWorthDescribing(job.which.size(), state_.tuning.leastOverlaps)) {
      fromRecords.insert(fromRecords.end(), job.which.begin(), job.which.end());
      job.which.clear();
    }
    putOff(fromRecords);
    BatchLane& lane = *piece.lane;
    std::shared_ptr<const PieceRecords> records;
    // The counters and contacts of `found` stay where they are meanwhile.
    if (!fromRecords.empty()) records = recordsOf(lane, scattered, count);
    if (!job.which.empty()) {
      job.holder = holders_.size();
      job.batch = &lane;
      if (makes) {
        for (const std::size_t i : job.which) job.tasks.push_back(overlapTask(source_.query(i)));
      }
      holders_.push_back({std::move(piece.lane), piece.repeats, begin, count, scattered, records});
      overlaps_.add(job);
    }
    finish_.chunk(begin, count, found);
    for (const std::size_t i : fromMeanwhile) keepMeanwhile(i);
    if (!fromRecords.empty()) dealOut(begin, *records, fromRecords);
    takeMade(begin, count, found);
    for (const std::size_t i : piece.refused) finish_.refuse(i);
  }

  /// Pairs of a piece whose contacts the device made remember that, and may wait for finish().
  void takeMade(std::size_t begin, std::size_t count, const BatchFound& found) {
    if constexpr (Finish::kTakesDescriptions) {
      if (request_ != BatchRequest::kSolid) return;
      std::vector<std::uint8_t> waits(count, 0), unsettled(count, 0);
      finish_.inParts(count, [&](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k) {
          if (!isRemembered(found.flags[k])) continue;
          const bool has = found.contacts[0].places[2 * k + 1] > 0;
          if (!has && !source_.anyHistory) continue;
          const Query query = source_.query(begin + k);
          waits[k] = mayMeetAhead_ && has && mayMeetAhead(query);
          if (source_.anyHistory) {
            rememberPlain(query, stateBefore(query), has, has ? found.directions[k] : Vec3d{0, 0, 0});
          }
          unsettled[k] = has && !finish_.isSettled(query, begin + k);
        }
      });
      for (std::size_t k = 0; k < count; ++k) {
        if (waits[k]) ahead_.push_back(begin + k);
        if (unsettled[k]) unsettled_.push_back(begin + k);
      }
    }
  }

  void finish() {
    if constexpr (Finish::kTakesDescriptions) {
      const Stopwatch watch(times_ != nullptr);
      const auto queryOf = [&](std::size_t i) { return source_.query(i); };
      if (!ahead_.empty()) good_ = finish_.lookAhead(ahead_, queryOf) && good_;
      finish_.settle(unsettled_, queryOf);
      if (times_) times_->host += watch.ms();
    }
  }

  /// A few pairs of solids, of which the device said late that it leaves them, wait for those of the other pieces: one
  /// after the other pieces would each wait for the slowest of theirs. Those of the other model are quickly made from
  /// records.
  void putOff(std::vector<std::size_t>& few) {
    if constexpr (Finish::kTakesDescriptions) {
      if (!mayWait(few.size(), request_ == BatchRequest::kSolid, finish_.hasThreads(), state_.tuning.meanwhile)) return;
      finish_.putOff(few.size());
      later_.insert(later_.end(), few.begin(), few.end());
      few.clear();
    }
  }

  void letGo(std::unique_ptr<BatchLane> lane, std::uint64_t repeats) {
    lane->letGo();
    lanes_.keep(std::move(lane), repeats);
  }

  /// Contacts of all pairs that are being described. Then their lanes are free.
  void finishOverlaps() {
    if constexpr (Finish::kTakesDescriptions) {
      overlaps_.finish([&](OverlapSubmission& job) { finishOverlap(job); });
      for (DescribedPiece& holder : holders_) {
        if (!holder.error) letGo(std::move(holder.lane), holder.repeats);
      }
      holders_.clear();
    }
  }

  void finishOverlap(OverlapSubmission& job) {
    if (job.error) {
      failed(*job.error, job.which);
      return;
    }
    const Stopwatch making(times_ != nullptr);
    if (times_) addTimes(*times_, job.lane->profile());
    std::vector<std::size_t> which, inVain;
    std::vector<std::uint32_t> places;
    for (std::uint32_t k = 0; k < job.which.size(); ++k) {
      if (job.lane->isDescribed(k)) {
        which.push_back(job.which[k]);
        places.push_back(k);
      } else {
        inVain.push_back(job.which[k]);
      }
    }
    const auto queryOf = [&](std::size_t i) { return source_.query(i); };
    std::size_t described = which.size();
    if (job.lane->hasContacts()) {
      const std::vector<std::size_t> bad =
          finish_.made(which, queryOf, [&](std::size_t k) { return job.lane->contacts(places[k]); });
      state_.contactsMade += which.size() - bad.size();
      state_.contactsLeft += bad.size();
      // Both ascend.
      std::vector<std::size_t> left;
      std::vector<std::uint32_t> rest;
      for (std::size_t k = 0, next = 0; next < bad.size(); ++k) {
        if (which[k] != bad[next]) continue;
        ++next;
        if (isApart(*job.lane->contacts(places[k]).head)) {
          inVain.push_back(which[k]);
        } else {
          left.push_back(which[k]);
          rest.push_back(places[k]);
        }
      }
      described -= bad.size() - left.size();
      which = left;
      places = rest;
    }
    if (!which.empty()) {
      try {
        if (job.lane->hasContacts()) job.lane->readDescriptions();
        const std::vector<std::size_t> bad =
            finish_.described(which, queryOf, [&](std::size_t k) { return job.lane->found(places[k]); });
        described -= bad.size();
        inVain.insert(inVain.end(), bad.begin(), bad.end());
      } catch (const ClError& error) {
        job.lane = nullptr;
        described -= which.size();
        failed(error, which);
      }
    }
    state_.described += described;
    if (!inVain.empty()) finishInVain(holders_[job.holder], inVain);
    if (times_) times_->host += making.ms();
  }

  /// Pairs of a piece that has ended, from their records. Others of it may be under way still, which need its lane.
  void finishInVain(DescribedPiece& holder, const std::vector<std::size_t>& which) {
    state_.describedInVain += which.size();
    try {
      if (!holder.error && !holder.records) {
        holder.records = recordsOf(*holder.lane, holder.scattered, holder.count);
      }
    } catch (const ClError& error) {
      holder.error = error;
    }
    if (holder.error) {
      failed(*holder.error, which);
    } else {
      dealOut(holder.begin, *holder.records, which);
    }
  }

  /// The device failed before these pairs were done.
  void failed(const ClError& error, const std::vector<std::size_t>& which) {
    logError(error);
    good_ = false;
    withoutDevice(which);
    state_.onHost += which.size();
  }

  void withoutDevice(const std::vector<std::size_t>& which) {
    if (!which.empty()) finish_.withoutDevice(which, [&](std::size_t i) { return source_.query(i); });
  }

  /// Of a piece that has ended. `scattered`: of all pairs, not only of those that are left.
  std::shared_ptr<const PieceRecords> recordsOf(BatchLane& lane, bool scattered, std::size_t count) {
    const Answer answer = scattered ? lane.records() : lane.recordsLeft();
    return std::make_shared<PieceRecords>(answer, count, finish_.onHost);
  }

  /// Gives each of `which` its records.
  void dealOut(std::size_t begin, const PieceRecords& records, const std::vector<std::size_t>& which) {
    finish_.records(
        which, records.answer, [&](std::size_t i) { return source_.query(i); },
        [&](std::size_t i) { return records.byPair.of(i - begin); });
  }

  BackendState& state_;
  const Source& source_;
  const BatchRequest request_;
  Finish& finish_;
  LanePool<BatchLane>& lanes_;
  const BatchRules rules_;
  std::vector<DescribedPiece> holders_;
  OverlapQueue overlaps_;
  bool good_ = true, anyLarge_ = false, hasContactsOfHost_ = false, mayMeetAhead_ = false;
  std::vector<std::size_t> ahead_, unsettled_;                 ///< pairs that wait for finish()
  std::vector<std::size_t> later_;                             ///< pairs for the CPU when all pieces are done
  std::unordered_map<std::size_t, ContactFinish::Done> done_;  ///< by the CPU, while the device is at work
  PieceMeshes meshes_;                                         ///< of the piece that was begun last
  std::size_t waits_ = 0;
  std::uint64_t largest_ = 0;  ///< triangles of the largest mesh
  StageTimes* times_ = nullptr;
};

template <class Source>
bool Backend::collideFrom(const Source& source, BatchAnswer& answer, StageTimes* times, const RunParts& onHost) {
  const Stopwatch total(times != nullptr);
  if (times) *times = {};
  state_->queries += source.size();
  answer.clear();
  ContactFinish finish{*this, state_->queries, answer, state_->workspaces};
  if (onHost) finish.onHost = &onHost;
  const BatchRequest request = !state_->reduces()                         ? BatchRequest::kPairs
                               : source.anySolid && state_->makesSolids() ? BatchRequest::kSolid
                               : source.anyPairwise                       ? BatchRequest::kContacts
                                                                          : BatchRequest::kPairs;
  Batch<Source, ContactFinish> batch(*state_, source, request, finish, times != nullptr);
  const bool good = batch.run(times);
  finish.end();
  if (times) times->total = total.ms();
  return good;
}

template <class Source>
bool Backend::intersectFrom(const Source& source, std::vector<std::uint8_t>& answer, StageTimes* times,
                            const RunParts& onHost) {
  const Stopwatch total(times != nullptr);
  if (times) *times = {};
  state_->queries += source.size();
  answer.assign(source.size(), 0);
  AnyFinish finish{answer};
  if (onHost) finish.onHost = &onHost;
  Batch<Source, AnyFinish> batch(*state_, source, BatchRequest::kAny, finish, times != nullptr);
  const bool good = batch.run(times);
  if (times) times->total = total.ms();
  return good;
}

bool Backend::collideBatch(const CollideBatch& pairs, BatchAnswer& answer, StageTimes* times, const RunParts& onHost) {
  const bool makesSolids = state_->makesSolids();
  if (const auto* numbered = std::get_if<NumberedPairs>(&pairs)) {
    return collideFrom(PairSource(*numbered, makesSolids), answer, times, onHost);
  }
  const auto* inRow = std::get_if<std::span<const Query>>(&pairs);
  const QueryList queries = inRow ? QueryList(*inRow) : QueryList(std::get<std::span<const Query* const>>(pairs));
  return collideFrom(QuerySource(queries, makesSolids, onHost), answer, times, onHost);
}

bool Backend::intersectBatch(const IntersectBatch& pairs, std::vector<std::uint8_t>& answer, StageTimes* times,
                             const RunParts& onHost) {
  const bool makesSolids = state_->makesSolids();
  if (const auto* numbered = std::get_if<NumberedPairs>(&pairs)) {
    return intersectFrom(PairSource(*numbered, makesSolids), answer, times, onHost);
  }
  if (const auto* queries = std::get_if<std::span<const Query>>(&pairs)) {
    return intersectFrom(QuerySource(QueryList(*queries), makesSolids, onHost), answer, times, onHost);
  }
  return intersectFrom(PosedSource(std::get<std::span<const PosedMeshes* const>>(pairs), onHost), answer, times,
                       onHost);
}

}  // namespace otg::opencl
