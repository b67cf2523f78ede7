#include "app/site_settings.h"

#include <fmt/format.h>

#include <cstdlib>
#include <map>

#include "planning_io/files/json_value.h"
#include "planning_io/files/safe_write.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

struct Unit {
    double mm;
    int decimals;
};
const std::map<std::string, Unit> kUnits{{"mm", {1, 1}}, {"cm", {10, 2}}, {"inch", {25.4, 3}}};

/// Away from the surgeon, in ct (LPS): where the letters' tops point. Zero: only a match tells.
const std::map<std::string, Eigen::Vector3d> kSides{
    {"feet", {0, 0, 1}}, {"head", {0, 0, -1}}, {"left", {-1, 0, 0}}, {"right", {1, 0, 0}}, {"view", {0, 0, 0}}};

const std::map<std::string, int> kThemes{{"bright", 0}, {"dark", 0}};
const std::map<std::string, int> kPapers{{"A4", 0}, {"Letter", 0}};

template <class Value>
std::string one_of(const JsonValue& value, const std::map<std::string, Value>& known) {
    const std::string word = value.text();
    if (known.contains(word)) return word;
    std::string words;
    for (const auto& entry : known) words += (words.empty() ? "\"" : ", \"") + entry.first + "\"";
    value.refuse("is \"" + word + "\"", "Write one of: " + words + ".");
}

/// Of the line to the archive; paths that begin nowhere begin beside the settings.
DicomTls tls_of(const JsonValue& value, const fs::path& settings) {
    value.has_only({"trusted", "certificate", "key", "name"});
    DicomTls tls;
    tls.wanted = true;
    const auto path = [&](const char* name, fs::path& to) {
        if (const auto entry = value.find(name)) to = settings.parent_path() / entry->text();
    };
    path("trusted", tls.trusted);
    path("certificate", tls.certificate);
    path("key", tls.key);
    if (const auto name = value.find("name")) tls.name = name->text();
    return tls;
}

const char* set(const char* variable) {
    const char* value = std::getenv(variable);
    return value && *value ? value : nullptr;
}

}  // namespace

fs::path site_settings_file() {
    const fs::path name = fs::path("planlight") / "config.json";
    if (const char* folder = set("XDG_CONFIG_HOME")) return folder / name;
    if (const char* home = set("HOME")) return fs::path(home) / ".config" / name;
    return {};
}

SiteSettings read_site_settings() {
    SiteSettings site;
    const fs::path file = site_settings_file();
    std::error_code ignored;
    if (file.empty() || !fs::exists(file, ignored)) return site;
    const Json json = parse_json(read_whole(file), file);
    const JsonValue root(json, file);
    check_format(root, "planlight config", 1, file);
    root.has_only({"format", "version", "units", "surgeon_side", "monitors", "language", "theme", "openigtlink",
                   "operator_name", "paper", "check_skin_every_min", "dicom"});
    if (const auto units = root.find("units")) site.units = one_of(*units, kUnits);
    if (const auto side = root.find("surgeon_side")) site.surgeon_side = one_of(*side, kSides);
    if (const auto language = root.find("language")) site.language = language->text();
    if (const auto theme = root.find("theme")) site.theme = one_of(*theme, kThemes);
    if (const auto paper = root.find("paper")) site.paper = one_of(*paper, kPapers);
    if (const auto every = root.find("check_skin_every_min")) site.check_skin_every_min = every->number(1, 60);
    if (const auto name = root.find("operator_name")) site.operator_name = name->text();
    if (const auto monitors = root.find("monitors")) {
        monitors->has_only({"operator", "projector"});
        if (const auto name = monitors->find("operator")) site.operator_monitor = name->text();
        if (const auto name = monitors->find("projector")) site.projector_monitor = name->text();
    }
    if (const auto link = root.find("openigtlink")) {
        link->has_only({"names"});
        if (const auto names = link->find("names")) site.openigtlink_names = names->flag();
    }
    if (const auto archive = root.find("dicom")) {
        archive->has_only({"own_title", "own_port", "host", "port", "title", "tls"});
        if (const auto title = archive->find("own_title")) site.archive.own_title = title->text();
        if (const auto host = archive->find("host")) site.archive.host = host->text();
        if (const auto port = archive->find("port")) site.archive.port = static_cast<int>(port->integer(1, 65535));
        if (const auto title = archive->find("title")) site.archive.title = title->text();
        if (const auto port = archive->find("own_port"))
            site.archive.own_port = static_cast<int>(port->integer(1, 65535));
        if (const auto tls = archive->find("tls")) site.archive.tls = tls_of(*tls, file);
    }
    site.read_from = file;
    return site;
}

std::vector<std::string> surgeon_sides() {
    std::vector<std::string> words;
    for (const auto& side : kSides) words.push_back(side.first);
    return words;
}

DrawingSettings drawing_settings(const SiteSettings& site) {
    DrawingSettings settings;
    settings.up_in_ct = kSides.at(site.surgeon_side);
    return settings;
}

std::string length_text(double mm, const SiteSettings& site) {
    const Unit& unit = kUnits.at(site.units);
    return fmt::format("{:.{}f} {}", mm / unit.mm, unit.decimals, site.units);
}

}  // namespace planlight
