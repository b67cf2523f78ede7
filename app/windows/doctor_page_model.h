#pragma once

#include <string>
#include <vector>

namespace planlight {

/// All that the page shows on which a room is examined before a patient comes, as values.
struct DoctorPageModel {
    enum class Health { good, look, stop };
    struct Line {
        std::string subject;  ///< "left camera, rate"
        Health health = Health::good;
        std::string said, remedy;  ///< sentences; the remedy is empty where nothing is to be done
        bool operator==(const Line&) const = default;
    };
    /// What the whole comes to: `looking` while it goes on, `ended` when somebody ended it before all was looked at.
    enum class Verdict { looking, ended, good, look, stop };

    std::string title, subtitle;
    Verdict verdict = Verdict::looking;
    std::string step;         ///< that is under way: "the cameras"; may be empty
    int took_s = 0;           ///< so far
    std::vector<Line> lines;  ///< as they were found
    bool operator==(const DoctorPageModel&) const = default;

    bool over() const { return verdict != Verdict::looking; }
    std::size_t count(Health health) const;
};

enum class DoctorPageAction { none, dark, again, quit };

/// The large word of a verdict: "STOP".
const char* doctor_word(DoctorPageModel::Verdict verdict);
/// Every word that it may be.
std::vector<std::string> doctor_words();

}  // namespace planlight
