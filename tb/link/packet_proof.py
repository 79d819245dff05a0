"""The properties of packet_sender, whatever comes and whenever the line takes a byte."""

from golden.link.packets import CHECK_BYTES, CHECK_PRESET, FRAME, SYNC, kind_byte
from golden.numbers.precision import SIGNAL
from tb.common.properties import Property
from tb.common.watch import check_byte


def packet_sender(twin):
    """The properties of the part. They say all that it does where no lessons come."""
    if twin.learns:
        return [lessons_told(), element_by_element(twin)]
    found = [
        follow_each_other(twin),
        checked(twin),
        begin(twin),
        tell(twin),
    ]
    if twin.points:
        found.append(point_by_point(twin))
    if twin.reload:
        found.append(nothing_untold())
    return found


def left_of(twin):
    """Verilog that counts the bytes of a packet that are still to be taken."""
    size = twin.layout.packet_bytes
    watch = f"""
        reg [{size.bit_length() - 1}:0] left = 0;
        always @(posedge clk)
            left <= rst ? 0 : begins ? {size} : left != 0 && out_ready ? left - 1 : left;
    """
    helps = (
        f"left <= {size}",
        "sending == (left != 0)",
        f"place == (left == 0 ? 0 : {size} - left)",
    )
    return watch, helps


def follow_each_other(twin):
    size = twin.layout.packet_bytes
    watch, helps = left_of(twin)
    return Property(
        name="bytes of a packet",
        sentence="A packet begins only in a clock in which the line is ready and no byte of "
        f"another packet is left. Its {size} bytes follow from the next clock on, each until it is "
        f"taken, and nothing else follows. The last {CHECK_BYTES} of them are the upper byte of "
        "check, and no byte before them is.",
        states=(
            "!begins || (out_ready && left == 0)",
            "out_valid == (left != 0)",
            f"!out_valid || place == {size} - left",
            f"left == 0 || out_data == (left > {CHECK_BYTES} ? first : check[15:8])",
        ),
        watch=watch,
        helps=helps,
        # A packet may begin in any clock here. When it begins is a property below.
        free=("complete", "waited", "check", "first"),
        reached=("left == 1",),
        refuted_by=(
            (r"out_ready && \(!sending\)", "(!sending)"),
            (r"out_ready && sending", "sending"),
            (rf"place == {size - 1}", f"place == {size - 2}"),
            (rf"place >= {size - CHECK_BYTES}", f"place >= {size - CHECK_BYTES + 1}"),
            (rf"place >= {size - CHECK_BYTES}", f"place >= {size - CHECK_BYTES - 1}"),
        ),
        clocks=size + 4,
    )


def checked(twin):
    return Property(
        name="check",
        sentence="check is the CRC of the bytes that were taken behind SYNC, computed bit by bit. "
        "Where its own upper byte is taken, its lower byte moves up.",
        states=(
            "!known || check == sum_before",
            "out_data != check[15:8] || following == {check[7:0], 8'h0}",
        ),
        watch=f"""
            reg known = 0;
            reg [15:0] sum_before;
            reg [15:0] sum;
            always @* begin
                sum = sum_before;
                {check_byte("out_data")}
            end
            always @(posedge clk) begin
                if (out_valid && out_ready) begin
                    known <= 1;
                    sum_before <= place == 0 ? {CHECK_PRESET} : sum;
                end
                if (rst) known <= 0;
            end
        """,
        helps=("known || place == 0",),
        free=("complete", "waited", "first"),
        reached=("known && place == 4",),
        refuted_by=(
            (r"check <= 65535;(?=\s+end\s+else begin\s+check)", "check <= 0;"),
            (r"place == 0\)", "place == 1)"),
            (r"check\[4\] \^ ", ""),
            (r"spread\[8-1:5\] \^ ", ""),
        ),
        clocks=8,
    )


def completes(twin):
    """What ends a frame: its last output, or the largest one where that is told."""
    return "winner_valid" if twin.decides else "result_valid && result_last"


def begin(twin):
    ends = "index and margin" if twin.decides else "the last output"
    return Property(
        name="begin of a packet",
        sentence=f"A packet begins one clock after {ends} of a frame, if the line is free "
        f"then, or where the line has been free for {twin.patience} clocks. Nothing else begins "
        "one.",
        states=(
            "begins == (out_ready && !sending && (ended || quiet == LONG - 1))",
            "waited == quiet",
        ),
        watch=f"""
            localparam [31:0] LONG = {twin.patience};
            wire completes = {completes(twin)};
            reg [31:0] quiet = 0;
            reg ended = 0;
            always @(posedge clk) begin
                quiet <= rst || begins || sending || !out_ready ? 0 : quiet + 1;
                ended <= !rst && completes;
            end
        """,
        helps=("quiet < LONG", "complete == ended"),
        reached=("begins",),
        refuted_by=(
            (r"waited \+ 1", "waited + 2"),
            (rf"waited == {twin.patience - 1}", "waited == 3"),
            (r"\(complete \|\| \(waited == \d+\)\)", "(waited == 3)"),
            (r"complete <= \(result_valid && result_last\)", "complete <= result_valid"),
            (r"\(free && \(!begins\)\)", "(out_ready && (!begins))"),
        ),
        clocks=8,
    )


def tell(twin):
    """The property that a byte with any chosen number in the packet has the right value."""
    codes, kept, watch = [], [], ""
    left, helps = left_of(twin)
    slots = (("sample", twin.inputs), ("result", twin.outputs))
    for frame, (stream, slot_count) in enumerate(slots):
        watch += f"""
            // Elements of this frame so far.
            reg [15:0] {stream}_place = 0;
            always @(posedge clk) begin
                if ({stream}_valid)
                    {stream}_place <= {stream}_last ? 0 : {stream}_place == 999 ? 999
                        : {stream}_place + 1;
                if (rst) {stream}_place <= 0;
            end
        """
        helps += (
            f"{stream}_place <= 999",
            f"keep_frame{frame}_count == ({stream}_place > {slot_count} ? {slot_count} "
            f": {stream}_place)",
        )
        for n in range(slot_count):
            code = f"newest_{stream}_{n}"
            watch += f"""
                reg [{SIGNAL.width - 1}:0] {code} = 0;
                always @(posedge clk)
                    if (rst) {code} <= 0;
                    else if ({stream}_valid && {stream}_place == {n}) {code} <= {stream}_data;
            """
            kept.append(f"keep_frame{frame}_keep_word{len(codes)}_word == {code}")
            codes.append(code)
    sign = 16 - SIGNAL.width
    shown = [f"{{{{{sign}{{{code}[{SIGNAL.width - 1}]}}}}, {code}}}" for code in codes]
    if twin.decides:
        index, margin = twin.argmax.index_fmt.width, twin.argmax.margin_fmt.width
        watch += f"""
            reg [7:0] newest_index = 0;
            reg [15:0] newest_margin = 0;
            always @(posedge clk) begin
                if (winner_valid) newest_index <= {{{8 - index}'d0, winner_index}};
                if (winner_valid) newest_margin <= {{{16 - margin}'d0, winner_margin}};
                if (rst) newest_index <= 0;
                if (rst) newest_margin <= 0;
            end
        """
        shown += ["newest_index", "newest_margin"]
        kept += ["keep_winner0_index == newest_index", "keep_winner0_margin == newest_margin"]
    if twin.points:
        shown += ["point"] + [
            f"{{{{{sign}{{next_point0_{axis}[{SIGNAL.width - 1}]}}}}, next_point0_{axis}}}"
            for axis in "xy"
        ]
    body = [f"8'd{n}" for n in (SYNC, kind_byte(FRAME), twin.layout.payload_bytes)]
    body += ["packets", "flags", "frames", *shown]
    count = twin.layout.packet_bytes - CHECK_BYTES
    stages = ["first", *(f"stage{n}_following" for n in range(count - 1))]
    return Property(
        name="what a packet tells",
        sentence="The bytes of a packet are SYNC, version and kind, the length, how many packets "
        "have begun before, the flags, how many frames have ended, the newest sample and the "
        "newest output of each place in a frame, "
        f"{'index and margin, ' * twin.decides}and the point where there is one. "
        "All of these are of the clock in which the packet begins, and none is from before a "
        "reset.",
        states=(
            f"!(sending && place == chosen && place < {count}) || out_data == word",
            "number == packets",
            "count == frames",
            *kept,
        ),
        watch=left
        + watch
        + f"""
            reg [7:0] packets = 0;
            reg [15:0] frames = 0;
            wire completes = {completes(twin)};
            wire [7:0] point = {"next_point0_number" if twin.points else "0"};
            wire [{8 * count - 1}:0] whole = {{{", ".join(body)}}};
            // Of any one byte, by its number, what it must be.
            reg [7:0] chosen;
            reg [7:0] word;
            always @(posedge clk) begin
                chosen <= chosen;
                if (begins) word <= whole >> (8 * ({count - 1} - chosen));
                packets <= rst ? 0 : packets + begins;
                frames <= rst ? 0 : frames + completes;
            end
        """,
        helps=(
            *helps,
            *(
                f"!sending || chosen >= {count} || chosen < place || chosen - place != {n} "
                f"|| {stage} == word"
                for n, stage in enumerate(stages)
            ),
        ),
        free=("complete", "waited", "flags", "check"),
        reached=("sending && place == 4 && chosen == 4",),
        refuted_by=(
            (r"count <= \(count \+ 1\)", "count <= (count + 2)"),
            (r"number <= \(number \+ 1\)", "number <= number"),
            (r"stage2_following <= number", "stage2_following <= flags"),
            (r"two_bytes0_high\[8-1:6\] = 3", "two_bytes0_low = 3"),
            (r"keep_frame0_count != 2", "1"),
            (r"first <= stage0_following", "first <= stage1_following"),
        ),
        clocks=12,
        whole=True,
    )


def in_turn(number, count, came, codes, shown, part, place="", below="<"):
    """What is common to the properties of ``count`` items that are shown one after the other.

    Its Verilog knows which item is shown, and the codes with which it came last. Where the item
    that is ``next`` comes, it takes the place of the one before.

    number: The name of the number of the item that is shown.
    came: In which clocks an item comes, and the number of the one that comes behind it.
    codes: For each name of a code, what it is when the item comes.
    shown: In which clocks an item has been shown, so that the next one is waited for.
    part: What the names of the shown item begin with.
    place: What those of the counters begin with, if not with the same.
    below: How ``at`` compares with ``count``: "<=" if it may stand behind the last item.
    """
    valid, behind = came
    keeps = "\n".join(f"{name} <= {code};" for name, code in codes.items())
    clears = "\n".join(f"{name} <= 0;" for name in ("at", "next", number, *codes))
    place = place or part
    watch = f"""
        reg [7:0] at = 0, next = 0, {number} = 0;
        reg [{SIGNAL.width - 1}:0] {", ".join(f"{name} = 0" for name in codes)};
        always @(posedge clk) begin
            at <= {behind};
            if ({valid} && at == next) begin
                {number} <= at;
                {keeps}
            end
            if ({shown}) next <= ({number} + 1) % {count};
            if (rst) begin
                {clears}
            end
        end
    """
    return {
        "watch": watch,
        "helps": (
            f"at {below} {count} && next < {count} && {number} < {count}",
            f"{place}place == at",
            f"{place}wanted == next",
        ),
        "reached": (f"{number} == 1 && next == 2",),
        "refuted_by": (
            (rf"{place}place == {place}wanted", "1"),
            (rf"{place}wanted <= 0", f"{place}wanted <= 1"),
            (rf"{part}number == {count - 1}", f"{part}number == 1"),
        ),
        "clocks": 12,
    }


def of_points(points, part, shown, place=""):
    """What is common to the properties of points that are shown one with each packet or profile."""
    behind = "!profile_valid ? at : profile_last ? 0 : at + 1"
    codes = {"x": "profile_x", "y": "profile_y"}
    assumes = {
        f"Each ramp has {points} points, as is proved of ramp.": "!profile_valid || "
        f"profile_last == (at == {points - 1})"
    }
    came = ("profile_valid", behind)
    return {"assumes": assumes, **in_turn("point", points, came, codes, shown, part, place)}


def point_by_point(twin):
    return Property(
        name="points",
        sentence="The point of a packet is the one that follows the point of the packet before on "
        "the ramp, as it came last. It is the same point again where the next one has not come "
        "since, and point 0 follows the last one.",
        states=("next_point0_number == point", "next_point0_x == x", "next_point0_y == y"),
        free=("begins",),
        **of_points(twin.points, "next_point0_", "begins"),
    )


def slow_points(points):
    """The property of the two densities of an instrument."""
    part = "slow_profile0_"
    common = of_points(points, part, "was_last", f"{part}next_point0_")
    common["watch"] = (
        "reg was_last = 0; always @(posedge clk) was_last <= !rst && profile_last;"
        + common["watch"]
    )
    common["refuted_by"] += (
        (r"\.in_data\(slow_profile0_y\)", ".in_data(slow_profile0_x)"),
        (r"slow_profile0_ended <= drawn_last", "slow_profile0_ended <= drawn_valid"),
        (r"(?s)(slow_profile0_end\b.*?)if \(rst == 1\)", r"\1if (0)"),
    )
    return Property(
        name="points given slowly",
        sentence="dac_x and dac_y give one point of the profile. Behind the last point of a "
        "profile the next point of the ramp is waited for, and point 0 follows the last one. "
        "Whatever profiles come, the codes are those with which the point came last.",
        states=(
            f"{part}number == point && {part}x == x && {part}y == y",
            "u_pulse_density_0.in_data == x && u_pulse_density_1.in_data == y",
            f"{part}ended == was_last",
        ),
        free=("drawn_valid", "drawn_x", "drawn_y", "drawn_last"),
        **common,
    )


def element_by_element(twin):
    part, count = "keep_element0_", twin.elements
    behind = f"result_valid && result_last ? 0 : theta_valid && at < {count} ? at + 1 : at"
    return Property(
        name="elements of theta",
        sentence="The element of theta in a packet is the one that follows the element of the "
        "packet before, as it came last behind a frame. It is the same element again where the "
        "next one has not come since, and element 0 follows the last one.",
        states=(f"{part}number == element", f"{part}element == code"),
        free=("begins",),
        **in_turn(
            *("element", count, ("theta_valid", behind), {"code": "theta_data"}, "begins", part),
            below="<=",
        ),
    )


def seen_since(*errors):
    """Verilog that keeps errors up to the next packet, and that the hardware keeps the same."""
    watch = "".join(
        f"""
        reg {error}_seen = 0;
        always @(posedge clk) {error}_seen <= !rst && !begins && ({error}_seen || {error}_error);
        """
        for error in errors
    )
    return watch, tuple(f"since_packet{n}_seen == {error}_seen" for n, error in enumerate(errors))


def lessons_told():
    watch, helps = seen_since("line", "lesson", "learn")
    return Property(
        name="lessons are told",
        sentence="When a packet begins, it reports every error of the line, of a lesson or of a "
        "step of learning that came since the packet before, including the clock in which it "
        "begins. converter_error and learning are reported as they are.",
        states=(
            "flags == {1'b0, learning, learn_seen || learn_error, lesson_seen || lesson_error, "
            "line_seen || line_error, 2'b0, converter_error}",
        ),
        watch=watch,
        helps=helps,
        free=("begins", "complete"),
        reached=("begins && flags == 121",),
        refuted_by=(
            (r"flags\[4\] = lessons", "flags[4] = 0"),
            (r"flags\[6\] = learning", "flags[6] = 0"),
            (r"since_packet2_seen <= \(steps && \(!begins\)\)", "since_packet2_seen <= 0"),
        ),
        clocks=6,
    )


def nothing_untold():
    watch, helps = seen_since("frame", "image", "line")
    return Property(
        name="nothing goes untold",
        sentence="When a packet begins, it reports every error of a frame, an image or the line "
        "that came since the packet before, including the clock in which it begins, and every "
        "frame that was refused since the frame before. converter_error is reported as it is.",
        states=(
            "flags == {4'b0, line_seen || line_error, image_seen || image_error, "
            "frame_seen || late || frame_error, converter_error}",
        ),
        watch=watch
        + """
            reg late = 0;
            always @(posedge clk) late <= !rst && !complete && (late || frame_error);
        """,
        helps=(*helps, "refused_frame0_refused == late"),
        free=("begins", "complete"),
        reached=("begins && flags == 15",),
        refuted_by=(
            (r"flags\[1\] = refused", "flags[1] = 0"),
            (r"since_packet1_seen <= \(images && \(!begins\)\)", "since_packet1_seen <= 0"),
            (r"refused_frame0_refused <= \(\(!complete\) && ", "refused_frame0_refused <= ("),
        ),
        clocks=6,
    )
