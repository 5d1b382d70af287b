#include "prepare/poses/match_chunk.h"

#include <string_view>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/deflate.h"
#include "core/base/file.h"
#include "core/base/log.h"

namespace skyquilt::prepare::poses {
namespace {

namespace fs = std::filesystem;

// The file: kMagic, length of the key and the key, number of pairs; for each pair both image ids, the number of matches and the matches; the CRC-32
// of all before. Numbers are 32-bit and little-endian.
constexpr std::string_view kMagic = "skyquilt matches 1\n";

void AddNumber(std::string& bytes, uint32_t number) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>((number >> shift) & 0xFFU));
}

uint32_t NumberAt(std::string_view bytes) {
  uint32_t number = 0;
  for (size_t i = 0; i < 4; ++i) number |= static_cast<uint32_t>(static_cast<unsigned char>(bytes[i])) << (8U * i);
  return number;
}

// Takes numbers from the front; false at the end.
bool TakeNumber(std::string_view& bytes, uint32_t* number) {
  if (bytes.size() < 4) return false;
  *number = NumberAt(bytes);
  bytes.remove_prefix(4);
  return true;
}

bool TakePair(std::string_view& bytes, survey::DatabaseMatches* matches) {
  uint32_t count = 0;
  if (!TakeNumber(bytes, &matches->images.first) || !TakeNumber(bytes, &matches->images.second) || !TakeNumber(bytes, &count)) return false;
  if (matches->images.first >= matches->images.second || count > bytes.size() / sizeof(survey::FeaturePair)) return false;
  matches->features.resize(count);
  for (survey::FeaturePair& pair : matches->features) {
    TakeNumber(bytes, &pair[0]);
    TakeNumber(bytes, &pair[1]);
  }
  return true;
}

}  // namespace

std::string ChunkKey(const std::string& input, std::span<const PhotoPair> pairs, const MatchRules& rules, size_t min_matches) {
  std::string text = input + " " + std::to_string(rules.max_ratio) + " " + std::to_string(rules.max_distance) + " " + std::to_string(rules.mutual) +
                     " " + std::to_string(min_matches);
  for (const PhotoPair& pair : pairs) text += "\n" + std::to_string(pair.a) + " " + std::to_string(pair.b);
  return base::HashHex(text);
}

std::vector<survey::DatabaseMatches> MatchChunk(FeatureStore& features, std::span<const PhotoPair> pairs, const MatchRules& rules, size_t min_matches,
                                                const std::function<void()>& on_pair, base::ThreadPool& threads) {
  std::vector<survey::DatabaseMatches> all(pairs.size());
  threads.ParallelFor(static_cast<int64_t>(pairs.size()), [&](int64_t task, int /*thread*/) {
    base::ThrowIfCancelled();
    const PhotoPair& pair = pairs[static_cast<size_t>(task)];
    // COLMAP's order of a pair is that of the image ids.
    uint32_t first = pair.a, second = pair.b;
    if (features.ImageId(first) > features.ImageId(second)) std::swap(first, second);
    const auto first_packed = features.Packed(first), second_packed = features.Packed(second);
    survey::DatabaseMatches& matches = all[static_cast<size_t>(task)];
    matches.images = {features.ImageId(first), features.ImageId(second)};
    const std::vector<FeatureMatch> found = MatchDescriptors(*first_packed, *second_packed, rules);
    if (found.size() >= min_matches) {
      matches.features.reserve(found.size());
      for (const FeatureMatch& match : found) matches.features.push_back({match.a, match.b});
    }
    on_pair();
  });
  return all;
}

void SaveChunk(const fs::path& file, const std::string& key, std::span<const survey::DatabaseMatches> matches) {
  std::string bytes(kMagic);
  AddNumber(bytes, static_cast<uint32_t>(key.size()));
  bytes += key;
  AddNumber(bytes, static_cast<uint32_t>(matches.size()));
  for (const survey::DatabaseMatches& pair : matches) {
    AddNumber(bytes, pair.images.first);
    AddNumber(bytes, pair.images.second);
    AddNumber(bytes, static_cast<uint32_t>(pair.features.size()));
    for (const survey::FeaturePair& features : pair.features) {
      AddNumber(bytes, features[0]);
      AddNumber(bytes, features[1]);
    }
  }
  AddNumber(bytes, base::Crc32(bytes));
  base::WriteFileAtomically(file, bytes);
}

std::optional<std::vector<survey::DatabaseMatches>> LoadChunk(const fs::path& file, const std::string& key) {
  if (!fs::exists(file)) return std::nullopt;
  const std::string bytes = base::ReadFile(file);
  const auto damaged = [&] {
    base::LogWarning("{} is damaged: its pairs are matched again", file.string());
    return std::nullopt;
  };
  if (bytes.size() < kMagic.size() + 4 || !bytes.starts_with(kMagic)) return damaged();
  std::string_view rest(bytes);
  if (NumberAt(rest.substr(rest.size() - 4)) != base::Crc32(rest.substr(0, rest.size() - 4))) return damaged();
  rest = rest.substr(kMagic.size(), rest.size() - kMagic.size() - 4);
  uint32_t key_size = 0, n_pairs = 0;
  if (!TakeNumber(rest, &key_size) || key_size > rest.size()) return damaged();
  if (rest.substr(0, key_size) != key) return std::nullopt;
  rest.remove_prefix(key_size);
  if (!TakeNumber(rest, &n_pairs) || n_pairs > rest.size() / 12) return damaged();
  std::vector<survey::DatabaseMatches> matches(n_pairs);
  for (survey::DatabaseMatches& pair : matches) {
    if (!TakePair(rest, &pair)) return damaged();
  }
  if (!rest.empty()) return damaged();
  return matches;
}

}  // namespace skyquilt::prepare::poses
