// What a fuzz target defines, and what runs it (driver.cpp, or libFuzzer with write_seeds.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

/// Feeds one input to the door under test. Aborts when a promise is broken; a refusal is no
/// failure.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

/// Sound inputs from which mutation starts.
std::vector<std::vector<std::uint8_t>> seedCorpus();
