#pragma once

#include <cstring>
#include <filesystem>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

namespace planlight {

/// Bytes that a child process hands to its parent: values as they lie in memory, one after the other.
class Parcel {
public:
    Parcel() = default;
    explicit Parcel(std::string bytes) : bytes_(std::move(bytes)) {}

    template <class T>
    void put(const T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    void put(const std::string& text) { put_all(text.data(), text.size()); }
    template <class T>
    void put(const std::vector<T>& list) {
        put_all(list.data(), list.size());
    }
    /// Throws std::out_of_range when the parcel holds less.
    template <class T>
    T get() {
        T value{};
        take(&value, sizeof value);
        return value;
    }
    std::string get_text() { return get_all<std::string>(); }
    template <class T>
    std::vector<T> get_list() {
        return get_all<std::vector<T>>();
    }
    const std::string& bytes() const { return bytes_; }

private:
    template <class T>
    void put_all(const T* values, std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        put(static_cast<std::uint64_t>(count));
        if (count > 0) bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(T));
    }
    template <class List>
    List get_all() {
        const auto count = get<std::uint64_t>();
        if (count > (bytes_.size() - at_) / sizeof(typename List::value_type)) throw std::out_of_range("parcel");
        List list(count, typename List::value_type{});
        if (count > 0) take(list.data(), count * sizeof(typename List::value_type));
        return list;
    }
    void take(void* to, std::size_t count);

    std::string bytes_;
    std::size_t at_ = 0;
};

/// Runs `parse` in a child process with limits (4 GiB of memory, 30 s of processor time) and gives what it put into its
/// parcel. An Error thrown there is thrown here again; a crash, an endless loop or any other exception is a
/// DamagedFileError of `file`: the child is lost, never the program. `what` names the kind of file in the sentence.
Parcel parse_in_child(const std::filesystem::path& file, const std::string& what, const std::function<void(Parcel&)>& parse);

}  // namespace planlight
