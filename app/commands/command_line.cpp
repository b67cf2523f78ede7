#include "app/commands/command_line.h"

namespace planlight {

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& what, const std::string& example) {
    CLI::App* command = app.add_subcommand(name, what);
    command->footer("Example:\n  planlight " + example);
    return command;
}

void json_flag(CLI::App* command, bool& json) {
    command->add_flag("--json", json, "Print the result as JSON on standard output");
}

const CLI::Validator& png_file() {
    static const CLI::Validator validator(
        [](std::string& name) {
            std::string ending = Path(name).extension().string();
            for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
            return ending == ".png" ? std::string() : name + " does not end in .png: pictures are written as PNG";
        },
        "FILE.png");
    return validator;
}

CLI::Option* preset_option(CLI::App* command, std::string& preset) {
    return command
        ->add_option("--preset", preset,
                     "Simulated room: modern (1920x1080, two 1920x1200) or paper (800x600, two 744x576)")
        ->check(CLI::IsMember({"modern", "paper"}))
        ->capture_default_str();
}

void series_option(CLI::App* command, std::string& series_uid) {
    command->add_option("--series", series_uid, "UID or number of the DICOM series, where the folder holds several");
}

void risk_options(CLI::App* command, std::vector<Path>& files, std::string& frame) {
    command
        ->add_option(
            "--risk", files,
            "Risk structure to measure the distance to: a closed surface (.stl, .ply, .obj, .vtp, .vtk) or the "
            "solids of an RTSTRUCT (.dcm); once for each file")
        ->allow_extra_args(false);
    command
        ->add_option("--risk-frame", frame,
                     "Coordinate system of risk structures that do not say their own (default: that of --frame)")
        ->check(CLI::IsMember({"LPS", "RAS"}));
}

void plan_frame_options(CLI::App* command, std::string& frame, std::string& accept_frame) {
    command->add_option("--frame", frame, "Coordinate system of plan files that do not say their own")
        ->check(CLI::IsMember({"LPS", "RAS"}));
    command->add_option("--accept-frame", accept_frame,
                        "DICOM frame of reference (UID) that is known to be the volume's");
}

}  // namespace planlight
