"""What is proved of packet_sender."""

from golden.link.packets import CHECK_BYTES, CHECK_PRESET, SYNC
from tb.sign_off.properties import Property

# x^16 + x^12 + x^5 + 1, without its highest power.
POLYNOMIAL = "16'h1021"


def properties(twin):
    size = twin.layout.packet_bytes
    step = "\n".join(
        f"sum = {{sum[14:0], 1'b0}} ^ (sum[15] ^ out_data[{n}] ? {POLYNOMIAL} : 16'h0);"
        for n in reversed(range(8))
    )
    packets = Property(
        name="packets",
        sentence="A packet begins in a clock of a free line: one after the last output of a "
        f"frame, or when the line has been free for {twin.patience} clocks. Its {size} bytes "
        "follow from the next clock on, each until it is taken, and nothing else does. The first "
        "is SYNC, and the check of all others is 0.",
        states=(
            "out_valid == (left != 0)",
            f"!(left == {size}) || out_data == {SYNC}",
            "left != 0 || !sent || sum_before == 0",
        ),
        watch=f"""
            reg [15:0] left = 0, quiet = 0;
            reg ended = 0, sent = 0;
            reg [15:0] sum_before = 0;
            reg [15:0] sum;
            wire starts = left == 0 && out_ready && (ended || quiet == {twin.patience - 1});
            always @* begin
                sum = sum_before;
                {step}
            end
            always @(posedge clk) begin
                ended <= result_valid && result_last;
                quiet <= left == 0 && out_ready && !starts ? quiet + 1 : 0;
                if (starts) left <= {size};
                else if (left != 0 && out_ready) begin
                    left <= left - 1;
                    sum_before <= left == {size} ? {CHECK_PRESET} : sum;
                    sent <= 1;
                end
                if (rst) begin left <= 0; quiet <= 0; ended <= 0; sent <= 0; end
            end
        """,
        helps=(
            f"left <= {size}",
            f"quiet < {twin.patience}",
            "waited == quiet",
            "complete == ended",
            "sending == (left != 0)",
            f"place == (left == 0 ? 0 : {size} - left)",
            f"left == 0 || left == {size} || check == sum_before",
            f"left != {size} || first == {SYNC}",
            "left != 1 || check[7:0] == 0",
            f"left == 0 || left == {size} || sent",
        ),
        reached=(f"left == {size}",),
        refuted_by=(
            (r"out_ready && \(!sending\)", "(!sending)"),
            (rf"waited == {twin.patience - 1}", f"waited == {twin.patience - 2}"),
            (rf"place == {size - 1}", f"place == {size - 2}"),
            (rf"place >= {size - CHECK_BYTES}", f"place >= {size - CHECK_BYTES + 1}"),
        ),
        clocks=size + 8,
    )
    found = [packets]
    if twin.reload:
        found.append(
            Property(
                name="nothing goes untold",
                sentence="When a packet begins, it tells of every error of a frame, an image or "
                "the line that came since the packet before, the clock of its begin included, and "
                "of every frame that was refused since the frame before; converter_error is told "
                "as it is.",
                states=(
                    "flags == {4'b0, lines_seen || line_error, images_seen || image_error, "
                    "frames_seen || late || frame_error, converter_error}",
                ),
                watch="""
                    reg lines_seen = 0, images_seen = 0, frames_seen = 0, late = 0;
                    always @(posedge clk) begin
                        lines_seen <= !rst && !begins && (lines_seen || line_error);
                        images_seen <= !rst && !begins && (images_seen || image_error);
                        frames_seen <= !rst && !begins && (frames_seen || frame_error);
                        late <= !rst && !complete && (late || frame_error);
                    end
                """,
                reached=("begins && flags == 15",),
                refuted_by=(
                    (r"flags\[1\] = refused", "flags[1] = 0"),
                    (r"since_packet1_seen <= \(images && \(!begins\)\)", "since_packet1_seen <= 0"),
                    (
                        r"refused_frame0_refused <= \(\(!complete\) && ",
                        "refused_frame0_refused <= (",
                    ),
                ),
            )
        )
    return found
