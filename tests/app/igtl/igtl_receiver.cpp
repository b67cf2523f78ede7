#include "tests/app/igtl/igtl_receiver.h"

#include <igtlClientSocket.h>
#include <igtlMessageHeader.h>
#include <igtlPolyDataMessage.h>
#include <igtlSensorMessage.h>
#include <igtlStatusMessage.h>
#include <igtlStringMessage.h>
#include <igtlTrackingDataMessage.h>
#include <igtlTransformMessage.h>

namespace planlight::test {
namespace {

Eigen::Matrix4d matrix_of(igtl::Matrix4x4& ras) {
    Eigen::Matrix4d matrix;
    for (Eigen::Index i = 0; i < 16; ++i) matrix(i / 4, i % 4) = ras[i / 4][i % 4];
    return matrix;
}

template <class Message>
typename Message::Pointer body(igtl::ClientSocket& socket, igtl::MessageHeader* header, ReceivedMessage& received) {
    auto message = Message::New();
    message->SetMessageHeader(header);
    message->AllocatePack();
    const int size = message->GetPackBodySize();
    received.sound = socket.Receive(message->GetPackBodyPointer(), size) == size &&
                     (message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY) != 0;
    return message;
}

void read_body(igtl::ClientSocket& socket, igtl::MessageHeader* header, ReceivedMessage& received) {
    igtl::Matrix4x4 ras;
    if (received.type == "TRANSFORM") {
        body<igtl::TransformMessage>(socket, header, received)->GetMatrix(ras);
        received.matrix = matrix_of(ras);
    } else if (received.type == "TDATA") {
        const auto message = body<igtl::TrackingDataMessage>(socket, header, received);
        for (int i = 0; i < message->GetNumberOfTrackingDataElements(); ++i) {
            igtl::TrackingDataElement::Pointer element;
            message->GetTrackingDataElement(i, element);
            element->GetMatrix(ras);
            received.transforms[element->GetName()] = matrix_of(ras);
        }
    } else if (received.type == "STATUS") {
        const auto message = body<igtl::StatusMessage>(socket, header, received);
        received.code = message->GetCode();
        received.word = message->GetErrorName();
        received.text = message->GetStatusString();
    } else if (received.type == "SENSOR") {
        const auto message = body<igtl::SensorMessage>(socket, header, received);
        auto millimetre = igtl::Unit::New();
        millimetre->SetPrefix(igtl::Unit::SI_PREFIX_MILLI);
        millimetre->Append(igtl::Unit::SI_BASE_METER, 1);
        received.in_mm = message->GetUnit() == millimetre->Pack();
        for (unsigned i = 0; i < message->GetLength(); ++i) received.numbers.push_back(message->GetValue(i));
    } else if (received.type == "STRING") {
        received.text = body<igtl::StringMessage>(socket, header, received)->GetString();
    } else if (received.type == "POLYDATA") {
        const auto message = body<igtl::PolyDataMessage>(socket, header, received);
        if (message->GetPoints()) received.points = message->GetPoints()->GetNumberOfPoints();
        if (message->GetPolygons()) received.polygons = static_cast<int>(message->GetPolygons()->GetNumberOfCells());
        if (message->GetLines()) received.lines = static_cast<int>(message->GetLines()->GetNumberOfCells());
    }
}

}  // namespace

IgtlReceiver::IgtlReceiver(int port) : thread_([this, port] { run(port); }) {}

IgtlReceiver::~IgtlReceiver() {
    if (thread_.joinable()) thread_.join();
}

const std::vector<ReceivedMessage>& IgtlReceiver::all() {
    if (thread_.joinable()) thread_.join();
    return messages_;
}

void IgtlReceiver::run(int port) {
    auto socket = igtl::ClientSocket::New();
    if (socket->ConnectToServer("127.0.0.1", port) != 0) return;
    connected_ = true;
    for (;;) {
        auto header = igtl::MessageHeader::New();
        header->InitPack();
        if (socket->Receive(header->GetPackPointer(), header->GetPackSize()) != header->GetPackSize()) return;
        header->Unpack();
        ReceivedMessage received;
        received.type = header->GetDeviceType();
        received.device = header->GetDeviceName();
        auto stamp = igtl::TimeStamp::New();
        header->GetTimeStamp(stamp);
        received.utc_s = stamp->GetTimeStamp();
        read_body(*socket, header, received);
        messages_.push_back(std::move(received));
    }
}

}  // namespace planlight::test
