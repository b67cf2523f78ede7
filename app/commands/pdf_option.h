#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>

#include "app/report/document.h"
#include "planning_io/files/safe_write.h"

namespace planlight {

/// --pdf: where the page of a command is written as PDF as well.
void pdf_option(CLI::App* command, std::filesystem::path& pdf);

/// Whether the file stands, or would stand, in that folder itself.
bool stands_in(const std::filesystem::path& file, const std::filesystem::path& folder);

/// To be asked before long work; `pdf` may be empty. Throws InputError where it is called as no PDF is (and so may be
/// another file of the command), DeviceError where the font is not installed, DiskError where it cannot be written.
/// `made`: a folder that the command makes; empty: none.
void check_pdf(const std::filesystem::path& pdf, const std::filesystem::path& made = {});

/// The document as PDF, on the site's paper; nothing where `pdf` is empty. One with a name or a face on it is its
/// owner's alone. Throws DeviceError where its font is not installed, DiskError.
void write_pdf(const Document& document, const std::filesystem::path& pdf, ReadableBy readable_by = ReadableBy::umask);

}  // namespace planlight
