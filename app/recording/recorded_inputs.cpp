#include "app/recording/recorded_inputs.h"

#include "planning_io/files/checked_chunks.h"
#include "planning_io/types/error.h"

namespace planlight {

using Kind = RecordedInput::Kind;

namespace {

[[noreturn]] void refuse(const std::filesystem::path& file) {
    throw DamagedFileError(file, "what its devices answered cannot be understood", "Copy the file again.");
}

bool has_text(Kind kind) {
    return kind != Kind::clock && kind != Kind::dark && kind != Kind::exposed;
}

}  // namespace

std::string packed(const std::vector<RecordedInput>& inputs) {
    FieldWriter fields;
    for (const RecordedInput& input : inputs) {
        fields.add(static_cast<std::uint8_t>(input.kind));
        if (input.kind == Kind::clock || input.kind == Kind::shown || input.kind == Kind::frame)
            fields.add(static_cast<std::int64_t>(input.at.count()));
        if (input.kind == Kind::shown || input.kind == Kind::frame)
            fields.add(static_cast<std::int64_t>(input.until.count()));
        if (input.kind == Kind::frame) fields.add(input.number);
        if (has_text(input.kind)) fields.add_text(input.text);
        if (input.kind == Kind::failed || input.kind == Kind::stopped) fields.add_text(input.remedy);
    }
    return fields.bytes();
}

std::vector<RecordedInput> unpacked_inputs(std::string_view payload, const std::filesystem::path& file) {
    try {
        FieldReader fields(payload, file);
        std::vector<RecordedInput> inputs;
        while (fields.left() > 0) {
            RecordedInput input;
            const auto kind = fields.next<std::uint8_t>();
            if (kind < 1 || kind > 8) refuse(file);
            input.kind = static_cast<Kind>(kind);
            if (input.kind == Kind::clock || input.kind == Kind::shown || input.kind == Kind::frame)
                input.at = Instant(fields.next<std::int64_t>());
            if (input.kind == Kind::shown || input.kind == Kind::frame)
                input.until = Instant(fields.next<std::int64_t>());
            if (input.kind == Kind::frame) input.number = fields.next<std::uint64_t>();
            if (has_text(input.kind)) input.text = fields.next_text();
            if (input.kind == Kind::failed || input.kind == Kind::stopped) input.remedy = fields.next_text();
            inputs.push_back(std::move(input));
        }
        return inputs;
    } catch (const DamagedFileError&) {
        refuse(file);
    }
}

}  // namespace planlight
