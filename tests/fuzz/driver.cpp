// Runs a fuzz target without libFuzzer: the seeds, every truncation of the small ones, then
// mutations.
//
// The same inputs in every run: `scene_fuzz [MUTATIONS]`. What was running when a sanitizer stopped
// the program is left in fuzz-input.bin in the working folder; `scene_fuzz FILE` runs one such
// input alone.
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>

#include "tests/fuzz/fuzz.h"

#if defined(__SANITIZE_ADDRESS__)
extern "C" void __sanitizer_set_death_callback(void (*callback)());
#endif

namespace {

using Input = std::vector<std::uint8_t>;

const Input* running = nullptr;

void keepInput() {
  if (running == nullptr) return;
  std::ofstream out("fuzz-input.bin", std::ios::binary);
  out.write(reinterpret_cast<const char*>(running->data()),
            static_cast<std::streamsize>(running->size()));
}

void runOne(const Input& input) {
  running = &input;
  // An exact copy on the heap, so that a read past the end is seen.
  const Input exact(input);
  LLVMFuzzerTestOneInput(exact.data(), exact.size());
  running = nullptr;
}

/// In [0, count). The bias of the remainder does not matter here.
std::size_t pick(std::mt19937_64& rng, std::size_t count) {
  return static_cast<std::size_t>(rng() % count);
}

bool isDigit(std::uint8_t byte) { return byte >= '0' && byte <= '9'; }

/// Replaces a decimal number of the text by one at an edge.
void editNumber(Input& input, std::mt19937_64& rng) {
  static constexpr std::string_view kEdges[] = {
      "0",          "-1",         "1",        "2147483647", "-2147483648",
      "4294967295", "4294967296", "65535",    "255",        "18446744073709551616",
      "nan",        "inf",        "1e39",     "1e-400",     "-0",
      "1.5",        "",           "99999999", "3",          "4097"};
  const std::size_t start = pick(rng, input.size());
  const auto first =
      std::find_if(input.begin() + static_cast<std::ptrdiff_t>(start), input.end(), isDigit);
  const auto last = std::find_if_not(first, input.end(), isDigit);
  const std::string_view edge = kEdges[pick(rng, std::size(kEdges))];
  const auto at = input.erase(first, last);
  input.insert(at, edge.begin(), edge.end());
}

/// Overwrites four bytes by a number at an edge, as binary formats have them.
void editWord(Input& input, std::mt19937_64& rng) {
  static constexpr std::uint32_t kEdges[] = {
      0, 1, 0xffffffffu, 0x7fffffffu, 0x80000000u, 0x7fc00000u, 0x7f800000u, 0xffffu, 0x10000u, 3};
  if (input.size() < 4) return;
  const std::uint32_t edge = kEdges[pick(rng, std::size(kEdges))];
  std::memcpy(input.data() + pick(rng, input.size() - 3), &edge, sizeof edge);
}

void mutate(Input& input, const std::vector<Input>& seeds, std::mt19937_64& rng) {
  const std::size_t edits = 1 + pick(rng, 4);
  for (std::size_t i = 0; i < edits && !input.empty(); ++i) {
    const std::size_t at = pick(rng, input.size());
    const auto here = input.begin() + static_cast<std::ptrdiff_t>(at);
    switch (pick(rng, 7)) {
      case 0:
        input[at] = static_cast<std::uint8_t>(input[at] ^ (1u << pick(rng, 8)));
        break;
      case 1:
        input[at] = static_cast<std::uint8_t>(rng());
        break;
      case 2: {
        const std::size_t length = std::min(input.size() - at, 1 + pick(rng, 16));
        input.erase(here, here + static_cast<std::ptrdiff_t>(length));
        break;
      }
      case 3: {  // splice: a piece of some seed
        const Input& other = seeds[pick(rng, seeds.size())];
        if (other.empty()) break;
        const std::size_t from = pick(rng, other.size());
        const std::size_t length = std::min(other.size() - from, 1 + pick(rng, 64));
        input.insert(here, other.begin() + static_cast<std::ptrdiff_t>(from),
                     other.begin() + static_cast<std::ptrdiff_t>(from + length));
        break;
      }
      case 4:
        input.resize(at);
        break;
      case 5:
        editWord(input, rng);
        break;
      default:
        editNumber(input, rng);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
#if defined(__SANITIZE_ADDRESS__)
  __sanitizer_set_death_callback(keepInput);
#else
  (void)keepInput;  // without a sanitizer nothing calls back
#endif
  std::size_t mutations = 2000;
  if (argc > 1) {
    const std::string_view argument = argv[1];
    const auto [end, error] =
        std::from_chars(argument.data(), argument.data() + argument.size(), mutations);
    if (error != std::errc{} || end != argument.data() + argument.size()) {
      std::ifstream file(argv[1], std::ios::binary);
      if (!file) {
        std::fprintf(stderr, "%s: no such file. Usage: [MUTATIONS | FILE]\n", argv[1]);
        return 2;
      }
      runOne(Input(std::istreambuf_iterator<char>(file), {}));
      return 0;
    }
  }
  const std::vector<Input> seeds = seedCorpus();
  if (seeds.empty()) {
    std::fprintf(stderr, "no seeds\n");
    return 1;
  }
  constexpr std::size_t kSmall = 1024;
  std::size_t runs = 0;
  for (const Input& seed : seeds) {
    runOne(seed);
    ++runs;
    for (std::size_t length = 0; seed.size() <= kSmall && length < seed.size(); ++length, ++runs) {
      runOne(Input(seed.begin(), seed.begin() + static_cast<std::ptrdiff_t>(length)));
    }
  }
  std::mt19937_64 rng(1);
  for (std::size_t i = 0; i < mutations; ++i, ++runs) {
    Input input = seeds[i % seeds.size()];
    mutate(input, seeds, rng);
    runOne(input);
  }
  std::printf("%zu inputs from %zu seeds\n", runs, seeds.size());
}
