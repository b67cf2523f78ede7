#include "planning_io/files/content_hash.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <bit>
#include <fstream>
#include <vector>

#include "planning_io/types/error.h"

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

std::string content_hash_of(const std::filesystem::path& file, const std::function<void()>& go_on) {
    ContentHash hash;
    std::ifstream in(file, std::ios::binary);
    if (!in) throw InputError(file, "cannot be opened", "Check the permissions of the file.");
    std::vector<char> block(std::size_t{1} << 18);
    while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0) {
        hash.add_bytes(block.data(), static_cast<std::size_t>(in.gcount()));
        if (go_on) go_on();
    }
    if (!in.eof()) throw InputError(file, "cannot be read", "Check the permissions of the file and the disk it is on.");
    return hash.hex();
}

}  // namespace planlight
