"""A Cortex-M core that runs an image as it is flashed: Unicorn executes its instructions, and this module is what
Unicorn lacks of the core: exceptions with their frames on the stack, sleep, faults, and time.

Time: an instruction takes `instruction_ns`, an access to a peripheral `ACCESS_NS` more. Neither is exact to the cycle.
Instructions run in stretches to the next thing that is due; an access that makes anything else due ends its stretch. A
stretch with an interrupt that waits for the core to unmask it is short, `MASKED_INSTRUCTIONS`, the longer it waits the
longer.

Exceptions (ARMv7-M Architecture Reference Manual, B1.5.6 to B1.5.8): the core saves a frame on the stack,

    r0 r1 r2 r3 r12 lr pc xpsr [s0 to s15, FPSCR, nothing]

the part in brackets where FPCCR says so, and enters the vector with a return address that is no address (EXC_RETURN).
Laziness is left out: the floats are saved at once.
"""

import struct
from collections import Counter
from collections.abc import Callable

import unicorn
from elftools.elf.elffile import ELFFile
from unicorn import arm_const as arm

from nvic import FIRST_INTERRUPT, HARD_FAULT, SystemControl
from peripheral import BLOCK_BITS, Bus
from schedule import Schedule
from unicorns import FLOATS, PLAIN, Instructions, Registers, map_callbacks

# An access to a register of a peripheral.
ACCESS_NS = 20
# The longest stretch, and those with an interrupt that waits: the first, and the longest.
STRETCH_INSTRUCTIONS, MASKED_INSTRUCTIONS = 1_000_000, (40, 5_000)

# Where code returns to that ends an exception: in a page where nothing is, so that Unicorn stops there.
_RETURN_PAGE = 0xFFFF_F000
_EXC_RETURN_FLOATS = 0xFFFF_FFE9
_EXC_RETURN_PLAIN = 0xFFFF_FFF9

# `b .`
_LOOP = b"\xfe\xe7"
_WFE, _WFI = b"\x20\xbf", b"\x30\xbf"

# What CFSR says of a fault: (without, with a valid address in BFAR).
PRECISE_BUS_FAULT, INSTRUCTION_BUS_FAULT, UNDEFINED = 1 << 9 | 1 << 15, 1 << 8, 1 << 16


class Core:
    """One core, its memory and the bus to its peripherals."""

    def __init__(self, model: int, part: int, hz: int, instruction_ns: float, memories: list[tuple[int, int]]) -> None:
        """`memories`: (address, bytes) of RAM and flash. `hz`: the core's clock once the image has set it."""
        self.schedule = Schedule()
        self.bus = Bus()
        self.system = SystemControl(part, lambda: self.schedule.now, lambda: hz)
        self.bus.add(self.system)
        self._instruction_ns = instruction_ns
        self.instructions = 0
        # Instructions of this stretch that `now` has counted already, and when the stretch ends.
        self._counted, self._stretch_end = 0, 0
        self.stopped: str | None = None
        self.pc = 0
        # Interrupts taken, and how long each waited at most, ns; the lowest address that the stack had at one.
        self.taken: Counter[int] = Counter()
        self.deepest_stack = 1 << 32
        self.idle_ns = 0
        self._masked_stretch = MASKED_INSTRUCTIONS[0]
        self._asleep = False
        self._woken = False
        self._hung: tuple[int, bytes] | None = None
        uc = self.uc = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
        uc.ctl_set_cpu_model(model)
        for address, size in memories:
            uc.mem_map(address, size)
        self._kept: list[object] = []
        self._error: BaseException | None = None
        self.map_peripherals(0xE000_0000, 0x10_0000)
        self._run = Instructions(uc, model)
        self._masks = Registers(uc, [arm.UC_ARM_REG_PRIMASK, arm.UC_ARM_REG_FAULTMASK, arm.UC_ARM_REG_BASEPRI])
        self._frame = Registers(uc, [*PLAIN, arm.UC_ARM_REG_XPSR, arm.UC_ARM_REG_SP])
        self._floats = Registers(uc, [*FLOATS, arm.UC_ARM_REG_FPSCR])
        self._pc = Registers(uc, [arm.UC_ARM_REG_PC])
        uc.hook_add(unicorn.UC_HOOK_MEM_UNMAPPED, self._unmapped)
        uc.hook_add(unicorn.UC_HOOK_INSN_INVALID, self._undefined)
        uc.hook_add(unicorn.UC_HOOK_INTR, self._trapped)

    def map_peripherals(self, address: int, size: int) -> None:
        """Sends accesses to these addresses to the bus."""
        self.map_memory(address, size, self._read, self._write)

    def map_memory(self, address: int, size: int, read: Callable[[int, int], int],
                   write: Callable[[int, int, int], None]) -> None:
        """Sends accesses to these addresses to a model."""
        self._kept.append(map_callbacks(self.uc, address, size, read, write, self._failed))

    def load(self, path: str) -> int:
        """Writes an ELF file's contents to memory; the address of its vector table."""
        self._image = path
        with open(path, "rb") as file:
            elf = ELFFile(file)
            for segment in elf.iter_segments():
                if segment["p_type"] == "PT_LOAD" and segment["p_filesz"]:
                    self.uc.mem_write(segment["p_paddr"], segment.data())
            text = elf.get_section_by_name(".text")
            self._watch_sleep(text["sh_addr"], text.data())
            return elf.get_section_by_name(".vector_table")["sh_addr"]

    def _watch_sleep(self, base: int, code: bytes) -> None:
        """The image's instructions stay as they are: the core stops before each that sleeps."""
        for instruction in (_WFE, _WFI):
            offset = code.find(instruction)
            while offset >= 0:
                if offset % 2 == 0:
                    self.uc.hook_add(unicorn.UC_HOOK_CODE, self._sleep, begin=base + offset, end=base + offset)
                offset = code.find(instruction, offset + 1)

    def _address(self, function: str) -> int:
        """Of a function of the image."""
        with open(self._image, "rb") as file:
            symbols = ELFFile(file).get_section_by_name(".symtab")
            return next(symbol["st_value"] for symbol in symbols.iter_symbols() if symbol.name == function) & ~1

    def spin(self) -> None:
        """Code polls for what takes a while: time goes on to the next thing that is due."""
        schedule = self.schedule
        schedule.now = max(schedule.now, min(schedule.next_due, self._stretch_end))

    def begin(self, vector_table: int) -> None:
        """Starts at a vector table as the hardware does after a reset, or as a bootloader does."""
        stack, entry = struct.unpack("<II", self.uc.mem_read(vector_table, 8))
        self.uc.reg_write(arm.UC_ARM_REG_SP, stack)
        self.pc = entry & ~1
        self._asleep = self._woken = False

    def reset(self) -> None:
        """The registers as after a reset; `begin` sets those that a start gives."""
        self.stopped, self._asleep, self._woken = None, False, False
        if self._hung is not None:
            self.replace(*self._hung)
            self._hung = None
        for register in (arm.UC_ARM_REG_PRIMASK, arm.UC_ARM_REG_BASEPRI, arm.UC_ARM_REG_FAULTMASK,
                         arm.UC_ARM_REG_CONTROL):
            self.uc.reg_write(register, 0)

    def set_control(self, *, process_stack: bool = False, float_in_use: bool = False) -> None:
        """CONTROL as a bootloader's task leaves it: SPSEL with a stack of its own, FPCA."""
        if process_stack:
            self.uc.reg_write(arm.UC_ARM_REG_PSP, self.uc.reg_read(arm.UC_ARM_REG_MSP) - 0x1000)
        self.uc.reg_write(arm.UC_ARM_REG_CONTROL, 2 * process_stack | 4 * float_in_use)

    def mask(self) -> None:
        """PRIMASK, as a bootloader leaves it."""
        self.uc.reg_write(arm.UC_ARM_REG_PRIMASK, 1)

    def replace(self, address: int, code: bytes) -> None:
        """Puts other instructions in place of those at `address`, to spoil a run."""
        self.uc.mem_write(address & ~1, code)
        self.uc.ctl_remove_cache(address & ~1, (address & ~1) + len(code))

    def hang(self) -> None:
        """The core goes round in a loop where it is, its interrupts masked, until it is reset."""
        self._wake()
        self.mask()
        self._hang_at(self.pc)

    def hang_in(self, function: str) -> None:
        """A function of the image never comes back, until the core is reset."""
        self._hang_at(self._address(function))

    def _hang_at(self, place: int) -> None:
        self._hung = place, bytes(self.uc.mem_read(place, 2))
        self.replace(place, _LOOP)

    # What Unicorn calls.

    def _pass_time(self) -> None:
        """`now` is that of the instruction at hand."""
        run = self._run.run()
        self.schedule.now += int((run - self._counted) * self._instruction_ns)
        self._counted = run

    def _failed(self, error: BaseException) -> None:
        self._error = error
        self._run.stop()

    def _read(self, address: int, size: int) -> int:
        self._pass_time()
        schedule = self.schedule
        schedule.now += ACCESS_NS
        if schedule.now >= self._stretch_end:
            self._run.stop()
        # The most frequent way through the bus, without its detours.
        peripheral = self.bus.blocks.get(address >> BLOCK_BITS)
        if size == 4 and peripheral is not None and address - peripheral.base in peripheral.KNOWN:
            return peripheral.read(address - peripheral.base)
        return self.bus.read(address, size)

    def _write(self, address: int, size: int, value: int) -> None:
        self._pass_time()
        schedule, system = self.schedule, self.system
        schedule.now += ACCESS_NS
        changes = system.changes
        self.bus.write(address, size, value)
        if (schedule.next_due < self._stretch_end or schedule.now >= self._stretch_end or self.stopped is not None
                or system.changes != changes and system.pending and system.next_exception(0, 0) is not None):
            self._run.stop()

    def _sleep(self, uc: unicorn.Uc, address: int, _size: int, _user: object) -> None:
        self._asleep, self._resume = True, address + 2
        uc.emu_stop()

    def _unmapped(self, uc: unicorn.Uc, access: int, address: int, _size: int, _value: int, _user: object) -> bool:
        fetch = access in (unicorn.UC_MEM_FETCH_UNMAPPED, unicorn.UC_MEM_FETCH_PROT)
        self._fault = (INSTRUCTION_BUS_FAULT, None) if fetch else (PRECISE_BUS_FAULT, address)
        return False

    def _undefined(self, _uc: unicorn.Uc, _user: object) -> bool:
        self._fault = (UNDEFINED, None)
        return False

    def _trapped(self, uc: unicorn.Uc, _number: int, _user: object) -> None:
        self._fault = (UNDEFINED, None)
        uc.emu_stop()

    # Running.

    @property
    def faults_masked(self) -> bool:
        """FAULTMASK."""
        return bool(self._masks.read()[1] & 1)

    def _next(self) -> int | None:
        primask, faultmask, basepri = self._masks.read()
        return None if faultmask & 1 else self.system.next_exception(primask & 1, basepri & 0xFF)

    def run(self, until_ns: int) -> None:
        """Runs until that time, or until something stops the core: `stopped` says what."""
        schedule, system = self.schedule, self.system
        while schedule.now < until_ns and self.stopped is None:
            if schedule.next_due <= schedule.now:
                schedule.run_due()
                if self.stopped is not None:
                    return
            exception = self._next() if system.pending else None
            if exception is not None:
                self._wake()
                self._enter(exception)
            elif self._asleep:
                if self._woken or system.pending and system.wakes():
                    self._wake()
                else:
                    slept = max(0, min(schedule.next_due, until_ns) - schedule.now)
                    self.idle_ns += slept
                    schedule.now += slept
                    continue
            self._execute(min(schedule.next_due, until_ns))

    def _execute(self, until_ns: int) -> None:
        """One stretch of instructions."""
        schedule, system = self.schedule, self.system
        self._stretch_end = until_ns
        limit = max(1, min(STRETCH_INSTRUCTIONS, int((until_ns - schedule.now) / self._instruction_ns) + 1))
        if system.pending and system.next_exception(0, 0) is not None:
            limit = min(limit, self._masked_stretch)
            self._masked_stretch = min(2 * self._masked_stretch, MASKED_INSTRUCTIONS[1])
        else:
            self._masked_stretch = MASKED_INSTRUCTIONS[0]
        self._fault: tuple[int, int | None] | None = None
        self._counted = 0
        try:
            self.uc.emu_start(self.pc | 1, 0, count=limit)
        except unicorn.UcError as error:
            if self._fault is None:
                self.stopped = f"{error} at {self.uc.reg_read(arm.UC_ARM_REG_PC):#x}"
                return
        if self._error is not None:
            error, self._error = self._error, None
            raise error
        self._pass_time()
        self.instructions += self._counted
        self.pc = self._pc.read()[0] & 0xFFFF_FFFE
        if self.pc >= _RETURN_PAGE:
            self._leave()
        elif self._fault is not None:
            self._take_fault(*self._fault)

    def _wake(self) -> None:
        if self._asleep:
            self.pc, self._asleep, self._woken = self._resume, False, False

    def _take_fault(self, status: int, address: int | None) -> None:
        if self.system.priority < 0:
            self.stopped = f"a fault in a fault, at {self.pc:#x}: the core locks up"
            return
        self.system.fault(status, address)
        self._enter(HARD_FAULT)

    def fail(self) -> None:
        """A hard fault at the instruction that would come next: an undefined one, say."""
        self._wake()
        self._take_fault(UNDEFINED, None)

    def _enter(self, exception: int) -> None:
        system, saves_floats = self.system, self.system.saves_floats
        values = self._frame.read()
        *words, flags, sp = [value & 0xFFFF_FFFF for value in values]
        size = 104 if saves_floats else 32
        frame = sp - size & ~7
        number = system.active[-1][0] if system.active else 0
        flags = flags & 0xF900_0000 | 1 << 24 | (0x200 if sp - size & 4 else 0) | number
        saved = struct.pack("<8I", *words, self.pc, flags)
        if saves_floats:
            *doubles, status = self._floats.read()
            saved += struct.pack("<8Q2I", *doubles, status & 0xFFFF_FFFF, 0)
        self.uc.mem_write(frame, saved)
        values[5] = _EXC_RETURN_FLOATS if saves_floats else _EXC_RETURN_PLAIN
        values[7] = frame
        self._frame.write()
        self.deepest_stack = min(self.deepest_stack, frame)
        system.enter(exception)
        self.taken[exception - FIRST_INTERRUPT] += 1
        vector = struct.unpack("<I", self.uc.mem_read(system.vector_table + 4 * exception, 4))[0]
        self.pc = vector & ~1

    def _leave(self) -> None:
        has_floats = not self.pc & 0x10
        values = self._frame.read()
        frame = values[7] & 0xFFFF_FFFF
        saved = self.uc.mem_read(frame, 104 if has_floats else 32)
        *words, pc, flags = struct.unpack_from("<8I", saved)
        if has_floats:
            self._floats.values[:] = struct.unpack_from("<8QI", saved, 32)
            self._floats.write()
        values[:] = [*words, flags & 0xF900_0000, frame + len(saved) + (4 if flags & 0x200 else 0)]
        self._frame.write()
        self.pc = pc & ~1
        self._woken = True
        self.system.leave()
