#include "tests/app/read_pdf.h"

#include <zlib.h>

#include <stdexcept>

namespace planlight::test {
namespace {

/// Empty where it is not compressed so.
std::string inflated(const std::string& bytes) {
    z_stream stream{};
    if (inflateInit(&stream) != Z_OK) throw std::runtime_error("zlib does not begin");
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    std::string all;
    for (int state = Z_OK; state == Z_OK;) {
        char part[65536];
        stream.next_out = reinterpret_cast<Bytef*>(part);
        stream.avail_out = sizeof part;
        state = inflate(&stream, Z_NO_FLUSH);
        all.append(part, sizeof part - stream.avail_out);
    }
    inflateEnd(&stream);
    return all;
}

void add_utf8(unsigned code, std::string& text) {
    if (code < 0x80) {
        text += static_cast<char>(code);
    } else if (code < 0x800) {
        text += static_cast<char>(0xC0 | code >> 6);
        text += static_cast<char>(0x80 | (code & 0x3F));
    } else {
        text += static_cast<char>(0xE0 | code >> 12);
        text += static_cast<char>(0x80 | (code >> 6 & 0x3F));
        text += static_cast<char>(0x80 | (code & 0x3F));
    }
}

/// Of "<004D00FC> Tj": four digits a letter.
std::string words_in(const std::string& content) {
    std::string text;
    for (std::size_t end = content.find("> Tj"); end != std::string::npos; end = content.find("> Tj", end + 1)) {
        for (std::size_t at = content.rfind('<', end) + 1; at + 4 <= end; at += 4)
            add_utf8(static_cast<unsigned>(std::stoul(content.substr(at, 4), nullptr, 16)), text);
        text += ' ';
    }
    for (std::size_t at = text.find("  "); at != std::string::npos; at = text.find("  ", at)) text.erase(at, 1);
    return text;
}

}  // namespace

std::vector<std::string> sheets_of(const std::string& pdf) {
    std::vector<std::string> sheets;
    for (std::size_t at = pdf.find("\nstream"); at != std::string::npos; at = pdf.find("\nstream", at)) {
        at = pdf.find('\n', at + 1) + 1;
        const std::string content = inflated(pdf.substr(at, pdf.find("\nendstream", at) - at));
        if (content.find(" Tj\nET") != std::string::npos) sheets.push_back(words_in(content));
    }
    return sheets;
}

std::string text_of(const std::string& pdf) {
    std::string all;
    for (const std::string& sheet : sheets_of(pdf)) all += sheet;
    return all;
}

}  // namespace planlight::test
