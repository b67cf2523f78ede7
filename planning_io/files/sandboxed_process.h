#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "planning_io/types/error.h"

namespace planlight {

/// Values that a child process hands to its parent, as they lie in memory, one after the other: an unnamed file in
/// memory that both have open. What is put or taken is not kept a second time here.
class Parcel {
public:
    Parcel();
    ~Parcel();
    Parcel(Parcel&& other) noexcept;
    Parcel& operator=(Parcel&&) = delete;

    template <class T>
    void put(const T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        write_all(&value, sizeof value);
    }
    void put(const std::string& text) { put_list(text.data(), text.size()); }
    template <class T>
    void put(const std::vector<T>& list) {
        put_list(list.data(), list.size());
    }
    /// Throws std::out_of_range when the parcel holds less.
    template <class T>
    T get() {
        T value{};
        read_all(&value, sizeof value);
        return value;
    }
    std::string get_text() { return get_all<std::string>(); }
    template <class T>
    std::vector<T> get_list() {
        return get_all<std::vector<T>>();
    }

    bool is_open() const { return fd_ >= 0; }
    void empty();                                 ///< what was put is gone
    void begin_reading();                         ///< from its first value
    std::uint64_t left() const { return left_; }  ///< bytes to read

private:
    template <class T>
    void put_list(const T* values, std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        put(static_cast<std::uint64_t>(count));
        write_all(values, count * sizeof(T));
    }
    template <class List>
    List get_all() {
        const auto count = get<std::uint64_t>();
        if (count > left_ / sizeof(typename List::value_type)) throw std::out_of_range("parcel");
        List list(count, typename List::value_type{});
        read_all(list.data(), count * sizeof(typename List::value_type));
        return list;
    }
    void write_all(const void* from, std::size_t bytes);  ///< throws std::bad_alloc when there is no room
    void read_all(void* to, std::size_t bytes);

    int fd_ = -1;
    std::uint64_t left_ = 0;
};

/// The child ended by a signal that its own steps raised: the file brought its parser down.
class ParserCrash : public DamagedFileError {
public:
    using DamagedFileError::DamagedFileError;
};

/// What a child may use; all of them get 4 GiB of memory, 8 GiB for their answer, and 4096 open files.
struct ChildLimits {
    std::string what = "file";  ///< the kind of file, for the sentences
    unsigned processor_s = 30;
    unsigned wait_s = 120;  ///< on the wall
    std::string when_too_large = "Give a smaller file.";
};

/// Runs `parse` in a child process within `limits` and gives what it put into its parcel. An Error thrown there is
/// thrown here again, with its exit code; more memory than it may have is an InputError that says how much, and where
/// the machine itself has less than that an Error of exit code 7; a crash, an endless loop or any other exception a
/// DamagedFileError (the first a ParserCrash): the child is lost, never the program.
Parcel parse_in_child(const std::filesystem::path& file, const ChildLimits& limits,
                      const std::function<void(Parcel&)>& parse);

}  // namespace planlight
