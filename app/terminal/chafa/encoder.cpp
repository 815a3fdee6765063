/// \file The encoder of terminal/encoder.h by chafa, a shared library of its own.

#include "app/terminal/encoder.h"

#include <chafa.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string_view>

extern char** environ;

namespace oktett {
namespace {

template <auto Free>
struct Freer {
  template <class T>
  void operator()(T* object) const {
    Free(object);
  }
};
using Terminal = std::unique_ptr<ChafaTermInfo, Freer<chafa_term_info_unref>>;
using Symbols = std::unique_ptr<ChafaSymbolMap, Freer<chafa_symbol_map_unref>>;
using Config = std::unique_ptr<ChafaCanvasConfig, Freer<chafa_canvas_config_unref>>;
using Canvas = std::unique_ptr<ChafaCanvas, Freer<chafa_canvas_unref>>;

Terminal present_terminal() { return Terminal(chafa_term_db_detect(chafa_term_db_get_default(), environ)); }

bool can(const Terminal& terminal, ChafaTermSeq sequence) {
  return chafa_term_info_have_seq(terminal.get(), sequence) != 0;
}

/// Those of formats that the terminal is not known to have.
void add_missing_sequences(const Terminal& terminal) {
  const Terminal fallback(chafa_term_db_get_fallback_info(chafa_term_db_get_default()));
  chafa_term_info_supplement(terminal.get(), fallback.get());
}

/// Colours and characters of blocks.
void set_blocks(ChafaCanvasConfig* config, const Terminal& terminal) {
  const bool direct = can(terminal, CHAFA_TERM_SEQ_SET_COLOR_FGBG_DIRECT),
             many = direct || can(terminal, CHAFA_TERM_SEQ_SET_COLOR_FGBG_256);
  chafa_canvas_config_set_canvas_mode(config, direct ? CHAFA_CANVAS_MODE_TRUECOLOR
                                              : many ? CHAFA_CANVAS_MODE_INDEXED_240
                                                     : CHAFA_CANVAS_MODE_INDEXED_16);
  if (!direct) chafa_canvas_config_set_dither_mode(config, CHAFA_DITHER_MODE_ORDERED);
  const Symbols symbols(chafa_symbol_map_new());
  chafa_symbol_map_add_by_tags(symbols.get(), CHAFA_SYMBOL_TAG_SPACE);
  chafa_symbol_map_add_by_tags(symbols.get(), CHAFA_SYMBOL_TAG_HALF);
  // Consoles of 16 colours have no quarters in their fonts.
  if (many) chafa_symbol_map_add_by_tags(symbols.get(), CHAFA_SYMBOL_TAG_QUAD);
  chafa_canvas_config_set_symbol_map(config, symbols.get());
  chafa_canvas_config_set_work_factor(config, 1);
}

/// Chafa 1.12 sends a wrong last byte with each chunk of kitty's protocol, so only the sequences are its own.
std::string encode_for_kitty(const Terminal& terminal, const TerminalPixels& pixels,
                             const TerminalCells& cells) {
  char sequence[CHAFA_TERM_SEQ_LENGTH_MAX];
  std::string bytes;
  const auto add = [&](const char* end) { bytes.append(sequence, static_cast<std::size_t>(end - sequence)); };
  add(chafa_term_info_emit_begin_kitty_immediate_image_v1(terminal.get(), sequence, 32, pixels.width,
                                                          pixels.height, static_cast<guint>(cells.columns),
                                                          static_cast<guint>(cells.rows)));
  // 4096 characters of base64, the most that a chunk may have.
  constexpr std::size_t kMost = 3072;
  for (std::size_t at = 0; at < pixels.rgba.size(); at += kMost) {
    gchar* const text = g_base64_encode(&pixels.rgba[at], std::min(kMost, pixels.rgba.size() - at));
    add(chafa_term_info_emit_begin_kitty_image_chunk(terminal.get(), sequence));
    bytes += text;
    add(chafa_term_info_emit_end_kitty_image_chunk(terminal.get(), sequence));
    g_free(text);
  }
  add(chafa_term_info_emit_end_kitty_image(terminal.get(), sequence));
  return bytes;
}

static_assert(CHAFA_SYMBOL_WIDTH_PIXELS == kBlockPixels && CHAFA_SYMBOL_HEIGHT_PIXELS == kBlockPixels);

class ChafaEncoder final : public TerminalEncoder {
 public:
  TerminalFormat best_format() const override {
    const Terminal terminal = present_terminal();
    if (can(terminal, CHAFA_TERM_SEQ_BEGIN_KITTY_IMMEDIATE_IMAGE_V1)) return TerminalFormat::kitty;
    // Multiplexers keep the variables of the terminal around them, but not what is sent by its protocol.
    const char* name = std::getenv("TERM");
    const std::string_view kind = name != nullptr ? name : "";
    if (kind.starts_with("screen") || kind.starts_with("tmux")) return TerminalFormat::blocks;
    if (can(terminal, CHAFA_TERM_SEQ_BEGIN_ITERM2_IMAGE)) return TerminalFormat::iterm;
    if (can(terminal, CHAFA_TERM_SEQ_BEGIN_SIXELS)) return TerminalFormat::sixel;
    return TerminalFormat::blocks;
  }

  std::string encode(const TerminalPixels& pixels, TerminalFormat format,
                     const TerminalCells& cells) const override {
    // No thread that the system may refuse.
    chafa_set_n_threads(1);
    const Terminal terminal = present_terminal();
    if (format == TerminalFormat::kitty) {
      add_missing_sequences(terminal);
      return encode_for_kitty(terminal, pixels, cells);
    }
    const Config config(chafa_canvas_config_new());
    const int width = static_cast<int>(pixels.width), height = static_cast<int>(pixels.height);
    // Chafa rounds the height of sixels down to a whole number of their rows. Cells of such a row lose
    // nothing.
    const bool sixels = format == TerminalFormat::sixel;
    chafa_canvas_config_set_geometry(config.get(), sixels ? width : cells.columns,
                                     sixels ? height / kSixelPixels : cells.rows);
    chafa_canvas_config_set_cell_geometry(config.get(), sixels ? 1 : cells.cell_width,
                                          sixels ? kSixelPixels : cells.cell_height);
    chafa_canvas_config_set_pixel_mode(config.get(), sixels ? CHAFA_PIXEL_MODE_SIXELS
                                                     : format == TerminalFormat::iterm
                                                         ? CHAFA_PIXEL_MODE_ITERM2
                                                         : CHAFA_PIXEL_MODE_SYMBOLS);
    if (format == TerminalFormat::blocks) set_blocks(config.get(), terminal);
    const Canvas canvas(chafa_canvas_new(config.get()));
    chafa_canvas_draw_all_pixels(canvas.get(), CHAFA_PIXEL_RGBA8_UNASSOCIATED, pixels.rgba.data(), width,
                                 height, 4 * width);
    add_missing_sequences(terminal);
    GString* const text = chafa_canvas_print(canvas.get(), terminal.get());
    std::string bytes(text->str, text->len);
    g_string_free(text, 1);
    return bytes;
  }
};

}  // namespace
}  // namespace oktett

extern "C" __attribute__((visibility("default"))) const oktett::TerminalEncoder* oktett_terminal_encoder();
const oktett::TerminalEncoder* oktett_terminal_encoder() {
  static const oktett::ChafaEncoder encoder;
  return &encoder;
}
