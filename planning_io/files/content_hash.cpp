#include "planning_io/files/content_hash.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <bit>

namespace planlight {

static_assert(std::endian::native == std::endian::little, "hashes and files are those of a little-endian machine");

struct ContentHash::State {
    std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> xxh{XXH3_createState(), XXH3_freeState};
};

ContentHash::ContentHash() : state_(std::make_unique<State>()) {
    XXH3_128bits_reset(state_->xxh.get());
}
ContentHash::~ContentHash() = default;

void ContentHash::add_bytes(const void* data, std::size_t bytes) {
    XXH3_128bits_update(state_->xxh.get(), data, bytes);
}

void ContentHash::add(std::string_view text) {
    add_bytes(text.data(), text.size());
    add_bytes("", 1);
}

std::string ContentHash::hex() const {
    const XXH128_hash_t digest = XXH3_128bits_digest(state_->xxh.get());
    return fmt::format("{:016x}{:016x}", digest.high64, digest.low64);
}

std::string content_hash(std::string_view content) {
    const XXH128_hash_t digest = XXH3_128bits(content.data(), content.size());
    return fmt::format("{:016x}{:016x}", digest.high64, digest.low64);
}

}  // namespace planlight
