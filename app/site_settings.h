#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planning_io/dicom_net/dicom_peer.h"
#include "projection/draw_plan.h"

namespace planlight {

/// What a site sets once, in planlight/config.json under $XDG_CONFIG_HOME (~/.config where that is not set):
/// {"format": "planlight config", "version": 1, "units": "mm" | "cm" | "inch", "surgeon_side": "feet" | "head" | "left"
/// | "right" | "view", "monitors": {"operator": "DP-1", "projector": "HDMI-2"}, "language": "de", "theme": "dark" |
/// "bright", "paper": "A4" | "Letter", "check_skin_every_min": 5, "openigtlink": {"names": true}, "operator_name": "Dr.
/// A. Meier", "dicom":
/// {"own_title": "PLANLIGHT", "host": "pacs", "port": 104, "title": "PACS"}}. Every name but the first two may be
/// missing.
struct SiteSettings {
    /// Unit of the lengths that commands print for a person. Files, JSON, windows and the light stay in mm.
    std::string units = "mm";
    /// Where the surgeon stands: labels on the skin are upright for somebody there; "view": as the left camera, and so
    /// the operator's window, sees them at the match.
    std::string surgeon_side = "feet";
    std::string language = "en";                      ///< of the operator's windows (app/words/README.md)
    std::string theme = "dark";                       ///< of the operator's windows
    std::string paper = "A4";                         ///< size of the sheets that PDF files are made of
    double check_skin_every_min = 0;                  ///< by a session itself, 1 to 60; 0: only when asked
    std::string operator_name;                        ///< who operates; empty: the account's. An option overrides it
    std::string operator_monitor, projector_monitor;  ///< names; empty: not set. An option of a command overrides them
    bool openigtlink_names = false;   ///< `session --igtl` says names of patient, case and plan to whoever listens
    DicomPeer archive;                ///< that `fetch` and `store` talk with; what is not set is as `DicomPeer` has it
    std::filesystem::path read_from;  ///< empty: there is no such file, and these are the defaults
};

/// Throws InputError for a file with an unknown name or word in it, DamagedFileError for one that is no JSON.
SiteSettings read_site_settings();

/// Where that file is looked for; empty without a home.
std::filesystem::path site_settings_file();

/// The words for `surgeon_side`.
std::vector<std::string> surgeon_sides();

/// How a plan is drawn on this site: labels upright for the surgeon ("view": `up_in_ct` is zero, see `lit_by`).
DrawingSettings drawing_settings(const SiteSettings& site);

/// A length in the site's unit, for a person: "1.2 mm", "0.12 cm", "0.047 inch".
std::string length_text(double mm, const SiteSettings& site);

}  // namespace planlight
