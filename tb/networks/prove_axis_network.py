"""Proved properties of axis_network, whatever either side does.

The network inside is cut off. Its results may have any value and come in any clock, as long as
there are no more results than good frames have been sent. This condition is proved of hybrid, in
its own cases, but not of cascade. The cases here hold no networks with past samples, and none that
take no sample while they compute.
"""

from tb.common.properties import Property
from tb.common.watch import ago, frames

# Cases with a least distance of frames, without slots and with them.
ALSO = ("axis", "slow-axis-cascade")


def properties(twin):
    outputs, slots, inputs = twin.outputs, twin.slots, twin.inputs
    under_way = twin.frames_under_way
    room = under_way * outputs
    cut = ("result_valid", "result", "frame_error")
    # With the largest output, a result comes to the memory one clock after the network gave it.
    comes, value, delayed, most = "result_valid", "result", "", "two"
    if twin.decides:
        comes, value, delayed, most = "stored_valid", "stored_data", " + stored_valid", "three"
    # The first frames only serve later ones as past samples.
    yields, whole = ("yields", " with a whole past") if twin.past else ("done", "")
    # This counts the outputs that are still to come for the frames that the network got.
    owed = f"""
        reg [15:0] owed = 0;
        always @(posedge clk)
            owed <= rst ? 0 : owed + ({yields} ? {outputs} : 0) - (result_valid ? 1 : 0);
    """
    network = {
        f"The network yields {outputs} outputs for each good frame{whole} sent to it, some time "
        "after it, and no others.": "!result_valid || owed != 0"
    }
    # Proved below, as "room".
    leaving = {"Only frames that are under way leave.": "!left || credit0_used != 0"}
    counted = (
        f"credit0_used <= {under_way}",
        f"place < {outputs}",
        # The outputs of every credit are still to come, in the memory, or fetched.
        f"credit0_used * {outputs} == owed + fifo0_stored + place{delayed}",
        f"fifo0_read_addr < {room} && fifo0_write_addr < {room} && fifo0_stored <= {room}",
        f"fifo0_write_addr + {room} * (fifo0_read_addr + fifo0_stored >= {room}) "
        "== fifo0_read_addr + fifo0_stored",
    )
    items = [
        Property(
            name="valid holds",
            sentence="Once m_axis_tvalid is high it stays so, and m_axis_tdata and m_axis_tlast "
            "stay as they are, until m_axis_tready is high too.",
            states=(
                "!waited || (m_axis_tvalid && m_axis_tdata == was_data "
                "&& m_axis_tlast == was_last)",
            ),
            watch="""
                reg waited = 0;
                reg signed [15:0] was_data;
                reg was_last;
                always @(posedge clk) begin
                    waited <= !rst && m_axis_tvalid && !m_axis_tready;
                    was_data <= m_axis_tdata;
                    was_last <= m_axis_tlast;
                end
            """,
            free=cut,
            reached=("waited", "m_axis_tvalid && m_axis_tready"),
            refuted_by=(
                (r"\(m_axis_tready \|\| \(!fifo0_full\)\)", "1"),
                (r"\(fifo0_full && \(!m_axis_tready\)\)", "0"),
                (r"if \(fetch\) begin\s+closing", "if (1) begin closing"),
            ),
        ),
        Property(
            name="frames under way",
            sentence=f"At most {under_way} frames are under way, from the last sample of each "
            "until its last output is fetched.",
            states=(f"credit0_used <= {under_way}",),
            assumes=leaving,
            free=("left",),
            reached=("full",),
            refuted_by=(
                (r"credit0_used == (\d+)", r"credit0_used == \1 + 1"),
                (r"credit0_used \+ 1", "credit0_used - 1"),
            ),
            # This admits one frame more than there is room for.
            clocks=under_way * twin.interval + 4,
        ),
        Property(
            name="ready",
            sentence="Once s_axis_tready is high it stays so until a sample is taken.",
            states=("!offered || s_axis_tready",),
            assumes=leaving,
            watch="""
                reg offered = 0;
                always @(posedge clk) offered <= !rst && s_axis_tready && !s_axis_tvalid;
            """,
            helps=(f"credit0_used <= {under_way}",),
            free=("left",),
            reached=("offered", "!s_axis_tready"),
            refuted_by=(
                (
                    r"assign s_axis_tready = gate0_ready",
                    "assign s_axis_tready = gate0_ready && m_axis_tready",
                ),
                (r"assign full = .*;", "assign full = left;"),
            ),
        ),
        Property(
            name="room",
            sentence=f"The memory never holds more than its {room} words, so no result is written "
            "over one that waits. Only frames that are under way leave.",
            states=(f"!{comes} || fifo0_stored < {room}", "!left || credit0_used != 0"),
            assumes=network,
            watch=owed,
            helps=counted,
            free=cut,
            reached=("left", "fifo0_stored == 2"),
            refuted_by=(
                (r"place == \d+\)\);", "place == 0));"),
                (r"if \(\(done && \(!left\)\)\)", "if ((done && (!left) && (!result_valid)))"),
                (r"fifo0_stored - 1", "fifo0_stored"),
            ),
            clocks=24,
        ),
        Property(
            name="no word lost",
            sentence="The outputs leave in the order in which they came from the network, each "
            f"once and no others. Each is offered at most {most} clocks after it came, or as soon "
            f"as those before it have left. m_axis_tlast comes with the last of each {outputs}.",
            states=(
                "!m_axis_tvalid || waiting != 0",
                "!waits || m_axis_tvalid",
                "!m_axis_tvalid || !tracked || ahead != 0 || m_axis_tdata == {{2{kept[13]}}, kept}",
                f"!m_axis_tvalid || m_axis_tlast == (number == {outputs - 1})",
            ),
            assumes=network,
            # For any one word this counts how many words must leave before it.
            watch=owed
            + f"""
                (* anyseq *) reg pick;
                reg tracked = 0, waits = 0;
                reg [15:0] waiting = 0, number = 0, ahead = 0;
                reg [13:0] kept;
                wire leaves = m_axis_tvalid && m_axis_tready;
                wire [15:0] home = fifo0_read_addr + ahead - fifo0_full;
                always @(posedge clk) begin
                    waiting <= waiting + {comes} - leaves;
                    waits <= waiting != leaves;
                    if (leaves) begin
                        number <= number == {outputs - 1} ? 0 : number + 1;
                        ahead <= ahead - 1;
                        if (ahead == 0) tracked <= 0;
                    end
                    if ({comes} && pick && !tracked) begin
                        tracked <= 1;
                        ahead <= waiting - leaves;
                        kept <= {value};
                    end
                    if (rst) begin
                        waiting <= 0;
                        waits <= 0;
                        number <= 0;
                        tracked <= 0;
                    end
                end
            """,
            helps=(
                *counted,
                "waiting == fifo0_stored + fifo0_full",
                f"number == (!fifo0_full ? place : place == 0 ? {outputs - 1} : place - 1)",
                "!fifo0_full || closing == (place == 0)",
                "!tracked || ahead < waiting",
                "!tracked || (fifo0_full && ahead == 0 ? word "
                f": fifo0_memory[home >= {room} ? home - {room} : home]) == kept",
            ),
            free=cut,
            reached=("tracked && ahead == 0 && leaves", "tracked && ahead == 1"),
            refuted_by=(
                (r"fifo0_write_addr \+ 1", "fifo0_write_addr + 2"),
                (r"memory\[fifo0_write_addr\]", "memory[0]"),
                (r"if \(\(result_valid && \(!fifo0_take\)\)\)", "if (result_valid)"),
                (r"else if \(\(fifo0_take && \(!result_valid\)\)\)", "else if (fifo0_take)"),
                (r"closing <= left", "closing <= (place == 0)"),
            ),
        ),
    ]
    inner = twin.network.input_controller
    accepted = "(s_axis_tvalid && s_axis_tready)"
    watch = frames(inputs, 0, accepted, "s_axis_tlast", "asked_")
    watch += frames(inner.inputs, twin.spacing, "valid", "last", "sent_")
    # A network that computes takes not even the first sample of another frame.
    computes = ("!(valid && sent_closed != 0)",) if twin.network.busy else ()
    helps = [
        "asked_place == gate0_place && asked_skipping == gate0_dropping && asked_closed == 0",
        f"asked_place < {inputs} && (!asked_skipping || asked_place == 0)",
        f"sent_place < {inner.inputs}",
    ]
    if slots:
        watch += ago("done_ago", "done", slots)
        helps += [
            "!sent_skipping",
            f"gate0_empty <= {slots}",
            "gate0_empty == 0 || (asked_place == 0 && !asked_skipping)",
            f"sent_place == (gate0_empty == 0 ? asked_place : {inner.inputs} - gate0_empty)",
            f"done_ago == (gate0_empty == 0 ? 0 : 1 << ({slots} - gate0_empty))",
        ]
        if twin.spacing:
            helps += [
                f"gate0_empty != 0 || sent_closed <= gate0_remaining + {slots}",
                "gate0_empty == 0 || sent_closed < gate0_empty",
                f"gate0_empty == 0 || gate0_remaining == {twin.spacing - 1 - slots} + gate0_empty",
            ]
        else:
            helps.append("sent_closed == 0")
    else:
        helps.append("sent_place == asked_place && sent_skipping == asked_skipping")
        helps.append(f"sent_closed == {'gate0_remaining' if twin.spacing else '0'}")
    if computes:
        helps.append("gate0_remaining == 0 || (asked_place == 0 && !asked_skipping)")
    with_slots = "with its slots behind its samples" if slots else "as it came"
    return [
        *items,
        Property(
            name="frames sent on",
            sentence=f"Each good frame is sent to the network once, {with_slots}, and never too "
            "close behind another. One wrong frame is sent for each wrong one. A reset ends what "
            "is under way.",
            states=(
                "done == asked_good",
                f"sent_good == {f'done_ago[{slots - 1}]' if slots else 'done'}",
                "sent_wrong == asked_wrong",
                *computes,
            ),
            watch=watch,
            helps=tuple(helps),
            free=cut,
            reached=("sent_good", "sent_wrong", "asked_skipping"),
            refuted_by=(
                (r"gate0_dropping <= \(!s_axis_tlast\)", "gate0_dropping <= s_axis_tlast"),
                (r"gate0_final && s_axis_tlast", "s_axis_tlast"),
                (r"gate0_final && gate0_held", "0")
                if twin.spacing
                else (r"gate0_empty <= 2", "gate0_empty <= 1"),
            ),
            clocks=20,
        ),
    ]
