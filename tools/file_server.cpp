#include "file_server.h"

#include <fmt/format.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <csignal>
#include <memory>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

#include "base/platform.h"
#include "occlod/base.h"
#include "served_files.h"

namespace occlod::tool {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using Tcp = asio::ip::tcp;
using ErrorCode = beast::error_code;

constexpr std::uint32_t max_header_bytes = 8192;
constexpr std::size_t part_bytes = std::size_t{1} << 16;

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

// Holds a file or text that is sent part by part.
class Answer {
 public:
  http::response<http::buffer_body> response;

  void take_text(std::string text) {
    text_ = std::move(text);
    range_ = {0, text_.size()};
  }
  void take_file(const std::filesystem::path& file) {
    file_ = std::make_unique<InputFile>(file.c_str());
    range_ = {0, file_->size()};
  }
  [[nodiscard]] std::uint64_t size() const { return range_.size; }
  void narrow(const ByteRange& range) { range_ = range; }
  // Sets the body to the next part; the last is empty. Throws std::system_error when a file was truncated.
  void next_part() {
    const std::size_t size = static_cast<std::size_t>(std::min<std::uint64_t>(part_bytes, range_.size));
    if (file_ != nullptr)
      file_->read(std::as_writable_bytes(std::span(part_.data(), size)), range_.first);
    else
      std::copy_n(text_.data() + range_.first, size, part_.data());
    range_ = {range_.first + size, range_.size - size};
    response.body().data = size > 0 ? part_.data() : nullptr;
    response.body().size = size;
    response.body().more = size > 0;
  }

 private:
  std::unique_ptr<InputFile> file_;
  std::string text_;
  ByteRange range_;
  std::array<char, part_bytes> part_{};
};

class Server;

// Handles one connection. Lives as long as an operation on it is pending.
class Session : public std::enable_shared_from_this<Session> {
 public:
  Session(Server& server, Tcp::socket socket) : server_(server), stream_(std::move(socket)) {}
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void read();

 private:
  void answer();
  void answer_file(const std::filesystem::path& file);
  void refuse(http::status status, std::string why);
  void choose(const std::string& path);
  void send();
  void send_parts();
  void end();

  Server& server_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{max_header_bytes};
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::optional<Answer> answer_;
  std::optional<http::response_serializer<http::buffer_body>> serializer_;
};

class Server {
 public:
  explicit Server(const ServerOptions& options)
      : options_(options), acceptor_(context_), signals_(context_, SIGINT, SIGTERM) {
    ErrorCode error;
    const Tcp::endpoint place(asio::ip::make_address(options.host, error), options.port);
    if (error)
      throw Error({options.host, "", "is no address", "give numbers: 127.0.0.1, ::1, or 0.0.0.0 for all of IPv4"});
    try {
      acceptor_.open(place.protocol());
      acceptor_.set_option(asio::socket_base::reuse_address(true));
      acceptor_.bind(place);
      acceptor_.listen();
    } catch (const boost::system::system_error& failure) {
      throw Error({fmt::format("port {} of {}", options.port, options.host), "",
                   "cannot be had: " + failure.code().message(),
                   "choose another port with --port, or 0 for any, and with --host an address of this machine"});
    }
  }

  void run(const std::function<void(std::uint16_t)>& ready) {
    signals_.async_wait([this](const ErrorCode& error, int) {
      if (!error) context_.stop();
    });
    accept();
    ready(acceptor_.local_endpoint().port());
    context_.run();
    is_ending_ = true;
  }

  [[nodiscard]] const ServerOptions& options() const { return options_; }

  void session_ended() {
    --sessions_;
    if (!is_accepting_ && !is_ending_) accept();
  }

 private:
  void accept() {
    is_accepting_ = sessions_ < options_.max_connections;
    if (!is_accepting_) return;
    acceptor_.async_accept([this](const ErrorCode& error, Tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (error) return wait();
      ++sessions_;
      std::make_shared<Session>(*this, std::move(socket))->read();
      accept();
    });
  }

  // Waits, for example when file descriptors are exhausted.
  void wait() {
    timer_.expires_after(std::chrono::milliseconds(100));
    timer_.async_wait([this](const ErrorCode& error) {
      if (!error) accept();
    });
  }

  const ServerOptions& options_;
  std::size_t sessions_ = 0;
  bool is_accepting_ = false;
  bool is_ending_ = false;       // remaining sessions end with the context
  asio::io_context context_{1};  // destroyed before what its handlers use
  Tcp::acceptor acceptor_;
  asio::signal_set signals_;
  asio::steady_timer timer_{context_};
};

Session::~Session() { server_.session_ended(); }

void Session::read() {
  parser_.emplace();
  parser_->header_limit(max_header_bytes);
  parser_->body_limit(0);
  stream_.expires_after(server_.options().patience);
  http::async_read_header(stream_, buffer_, *parser_, [self = shared_from_this()](const ErrorCode& error, std::size_t) {
    if (error == http::error::header_limit || error == http::error::buffer_overflow) {
      self->answer_.emplace();
      self->refuse(http::status::request_header_fields_too_large, "The header is too large.\n");
      self->answer_->response.keep_alive(false);
      return self->send();
    }
    if (!error) self->answer();
  });
}

void Session::answer() {
  const http::request<http::empty_body>& request = parser_->get();
  answer_.emplace();
  answer_->response.version(request.version());
  answer_->response.keep_alive(request.keep_alive());
  const std::optional<std::string> path = path_of_target(view_of(request.target()));
  if (request.method() != http::verb::get && request.method() != http::verb::head) {
    answer_->response.keep_alive(false);  // a body may follow
    refuse(http::status::method_not_allowed, "Only GET and HEAD are answered.\n");
    answer_->response.set(http::field::allow, "GET, HEAD");
  } else if (!path) {
    refuse(http::status::bad_request, "The address is none.\n");
  } else {
    choose(*path);
  }
  send();
}

void Session::choose(const std::string& path) {
  if (path == "/") {
    answer_->response.result(http::status::ok);
    answer_->response.set(http::field::content_type, "text/html; charset=utf-8");
    return answer_->take_text(server_.options().page);
  }
  for (const ServedFolder& served : server_.options().folders) {
    if (!path.starts_with(served.prefix)) continue;
    const std::optional<std::filesystem::path> file = file_in(served.folder, path.substr(served.prefix.size()));
    if (file) return answer_file(*file);
  }
  refuse(http::status::not_found, "There is no such file.\n");
}

void Session::answer_file(const std::filesystem::path& file) {
  http::response<http::buffer_body>& response = answer_->response;
  try {
    answer_->take_file(file);
  } catch (const std::system_error&) {
    return refuse(http::status::not_found, "The file cannot be read.\n");
  }
  const std::uint64_t size = answer_->size();
  response.set(http::field::accept_ranges, "bytes");
  response.set(http::field::cache_control, "no-cache");
  response.set(http::field::content_type, mime_type(file));
  response.result(http::status::ok);
  const auto wanted = parser_->get().find(http::field::range);
  if (wanted == parser_->get().end()) return;
  const std::optional<ByteRange> range = range_of(view_of(wanted->value()), size);
  if (!range) {
    refuse(http::status::range_not_satisfiable, "The file has no such bytes.\n");
    return response.set(http::field::content_range, fmt::format("bytes */{}", size));
  }
  if (range->size == size) return;
  answer_->narrow(*range);
  response.result(http::status::partial_content);
  response.set(http::field::content_range,
               fmt::format("bytes {}-{}/{}", range->first, range->first + range->size - 1, size));
}

void Session::refuse(http::status status, std::string why) {
  const bool keep_alive = answer_->response.keep_alive();
  const unsigned version = answer_->response.version();
  answer_.emplace();
  answer_->response.version(version);
  answer_->response.keep_alive(keep_alive);
  answer_->response.result(status);
  answer_->response.set(http::field::content_type, "text/plain; charset=utf-8");
  answer_->take_text(std::move(why));
}

void Session::send() {
  http::response<http::buffer_body>& response = answer_->response;
  response.set(http::field::access_control_allow_origin, "*");
  response.set("X-Content-Type-Options", "nosniff");
  response.content_length(answer_->size());
  response.body().more = true;
  serializer_.emplace(response);
  stream_.expires_after(server_.options().patience);
  http::async_write_header(stream_, *serializer_, [self = shared_from_this()](const ErrorCode& error, std::size_t) {
    if (error) return;
    if (self->parser_->get().method() == http::verb::head) return self->end();
    self->send_parts();
  });
}

void Session::send_parts() {
  try {
    answer_->next_part();
  } catch (const std::system_error&) {
    return;  // truncated: the client sees that the connection ends too early
  }
  stream_.expires_after(server_.options().patience);
  http::async_write(stream_, *serializer_, [self = shared_from_this()](const ErrorCode& error, std::size_t) {
    if (error == http::error::need_buffer) return self->send_parts();
    if (!error) self->end();
  });
}

void Session::end() {
  if (answer_->response.keep_alive()) return read();
  ErrorCode ignored;
  stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
}

}  // namespace

void serve(const ServerOptions& options, const std::function<void(std::uint16_t)>& ready) {
  Server(options).run(ready);
}

}  // namespace occlod::tool
