"""Proved properties of lesson_receiver, for any bytes."""

from golden.link.lesson_receiver import HEAD_BYTES
from golden.link.packets import CHECK_PRESET, LESSON, SYNC, kind_byte
from tb.common.properties import Property
from tb.common.watch import check_byte


def properties(twin):
    return [only_right_packets(twin), the_check(twin), whole_frames(twin)]


def only_right_packets(twin):
    end, bits = twin.packet_bytes - 1, HEAD_BYTES - 1
    return Property(
        name="only right packets",
        sentence="A packet counts in the clock of its last byte: behind SYNC, the byte of version "
        f"and kind and the length come {end - 2} bytes, none of them while codes leave, and the "
        f"check is right. No pause in it is {twin.idle_clocks} clocks long. Then learn becomes the "
        "lowest bit of its fourth byte, and target_theta the bit of theta. In no other clock does "
        "either change.",
        states=(
            f"right == (in_valid && bytes == {end} && !sending && following == 0)",
            "learn == taught",
            "target_theta == told",
        ),
        watch=f"""
            reg [7:0] bytes = 0;
            reg bit_of = 0, taught = 0, theta_of = 0, told = 0;
            wire silent = idle == {twin.idle_clocks - 1} && !in_valid;
            wire drops = in_valid && ((bytes == 2 && in_data != {twin.payload_bytes})
                || (bytes > 2 && sending) || bytes == {end});
            always @(posedge clk) begin
                if (in_valid) begin
                    if (bytes == {bits}) bit_of <= in_data[0];
                    if (bytes == {bits}) theta_of <= in_data[2];
                    if (bytes == 0) bytes <= in_data == {SYNC};
                    else if (bytes == 1)
                        bytes <= in_data == {kind_byte(LESSON)} ? 2 : in_data == {SYNC};
                    else bytes <= bytes + 1;
                    if (bytes == {end} && !sending && following == 0) taught <= bit_of;
                    if (bytes == {end} && !sending && following == 0) told <= theta_of;
                end
                if (silent || drops || rst) bytes <= 0;
                if (rst) taught <= 0;
                if (rst) told <= 0;
            end
        """,
        helps=(
            f"bytes == place && bytes <= {end}",
            f"bytes <= {bits} || (bit_of == learns && theta_of == puts)",
            f"!armed || bytes <= {bits}",
            f"!sending || bytes <= {bits + 1}",
        ),
        # The check is proved below. Silence may be counted in any way.
        free=("idle", "following"),
        reached=("right",),
        refuted_by=(
            (r"following == 0", "1"),
            (r"in_data == 19", "in_data[3:0] == 3"),
            (r"mode <= learns", "mode <= 1"),
            (r"putting <= puts", "putting <= 1"),
            (r"place == 2", "place == 3"),
        ),
        clocks=twin.packet_bytes + 3,
    )


def the_check(twin):
    return Property(
        name="the check",
        sentence="What must be 0 in the clock of the last byte is the CRC of all bytes behind "
        "SYNC, computed bit by bit.",
        states=("!(in_valid && place > 0) || following == sum",),
        watch=f"""
            reg [15:0] summed = 0, sum;
            always @* begin
                sum = place == 1 ? {CHECK_PRESET} : summed;
                {check_byte("in_data")}
            end
            always @(posedge clk) if (in_valid) summed <= sum;
        """,
        helps=(f"place == 0 || check == (place == 1 ? {CHECK_PRESET} : summed)",),
        free=("idle", "sending"),
        reached=("place == 4",),
        refuted_by=((r"check <= 65535;(?=\s+end\s+else begin\s+check)", "check <= 0;"),),
        clocks=6,
    )


def whole_frames(twin):
    count = f"(target_theta ? {twin.elements} : {twin.outputs})"
    return Property(
        name="whole frames of codes",
        sentence="Codes begin to leave only in the clock after frame_end, and only those of a "
        f"packet that was right before. {twin.outputs} known outputs leave or {twin.elements} "
        "elements of theta, one after the other, the last one with target_last. Each stays until "
        "it is taken, and so does target_theta.",
        states=(
            "target_valid == (left != 0)",
            "!target_valid || target_last == (left == 1)",
            "!stood || (target_valid && target_data == before)",
            "!went || target_theta == kind_before",
            "!armed || packets",
        ),
        watch=f"""
            reg [7:0] left = 0;
            reg stood = 0, packets = 0, went = 0, kind_before = 0;
            reg [13:0] before = 0;
            always @(posedge clk) begin
                if (frame_end && armed) left <= {count};
                else if (target_ready && left != 0) left <= left - 1;
                stood <= !rst && target_valid && !target_ready;
                before <= target_data;
                went <= !rst && target_valid && !target_last;
                kind_before <= target_theta;
                packets <= !rst && (packets || right);
                if (rst) left <= 0;
            end
        """,
        helps=(
            f"left <= {count} && (left == 0 ? count == 0 : count == {count} - left)",
            "!(sending && armed)",
            f"!armed || place <= {HEAD_BYTES - 1}",
            f"!sending || place <= {HEAD_BYTES}",
        ),
        free=("following",),
        reached=("target_valid && target_last",),
        refuted_by=(
            (r"frame_end && armed", "armed"),
            (r"place >= 3", "place >= 9"),
            (r"sending && target_ready", "sending"),
            (r"count == \d+", "count == 0"),
        ),
        clocks=twin.packet_bytes + 8,
    )
