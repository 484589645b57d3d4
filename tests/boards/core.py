"""A Cortex-M core that runs an image as it is flashed: Unicorn executes its instructions, and this module is what Unicorn
lacks of the core: exceptions with their frames on the stack, sleep, faults, and time.

Time: a block of code takes `ns_per_byte` for each of its bytes, an access to a peripheral `ACCESS_NS`. Neither is exact to
the cycle. An exception is taken between two blocks, as soon as it is due, more urgent than what runs, and not masked.

Exceptions (ARMv7-M Architecture Reference Manual, B1.5.6 to B1.5.8): the core saves a frame on the stack,

    r0 r1 r2 r3 r12 lr pc xpsr [s0 to s15, FPSCR, nothing]

the part in brackets where FPCCR says so, and enters the vector with a return address that is no address (EXC_RETURN).
Laziness is left out: the floats are saved at once.
"""

import struct
from collections import Counter

import unicorn
from elftools.elf.elffile import ELFFile
from unicorn import arm_const as arm

from nvic import FIRST_INTERRUPT, HARD_FAULT, SystemControl
from peripheral import Bus
from schedule import Schedule

# An access to a register of a peripheral.
ACCESS_NS = 20

# Where code returns to that ends an exception: in a page that nothing else has.
_RETURN_PAGE = 0xFFFF_F000
_EXC_RETURN_FLOATS = 0xFFFF_FFE9
_EXC_RETURN_PLAIN = 0xFFFF_FFF9

_PLAIN = [arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R1, arm.UC_ARM_REG_R2, arm.UC_ARM_REG_R3, arm.UC_ARM_REG_R12,
          arm.UC_ARM_REG_LR]
_FLOATS = [getattr(arm, f"UC_ARM_REG_D{number}") for number in range(8)]
_WFE, _WFI = b"\x20\xbf", b"\x30\xbf"

# What CFSR says of a fault: (without, with a valid address in BFAR).
PRECISE_BUS_FAULT, INSTRUCTION_BUS_FAULT, UNDEFINED = 1 << 9 | 1 << 15, 1 << 8, 1 << 16


class Core:
    """One core, its memory and the bus to its peripherals."""

    def __init__(self, model: int, part: int, hz: int, ns_per_byte: float, memories: list[tuple[int, int]]) -> None:
        """`memories`: (address, bytes) of RAM and flash. `hz`: the core's clock once the image has set it."""
        self.schedule = Schedule()
        self.bus = Bus()
        self.system = SystemControl(part, lambda: self.schedule.now, lambda: hz)
        self.bus.add(self.system)
        self.ns_per_byte = ns_per_byte
        self.stopped: str | None = None
        self.pc = 0
        # Interrupts taken, and how long each waited at most, ns; the lowest address that the stack had at one.
        self.taken: Counter[int] = Counter()
        self.deepest_stack = 1 << 32
        self.idle_ns = 0
        self._asleep = False
        self._woken = False
        self._sleeps: set[int] = set()
        uc = self.uc = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
        uc.ctl_set_cpu_model(model)
        for address, size in memories:
            uc.mem_map(address, size)
        uc.mem_map(_RETURN_PAGE, 0x1000)
        uc.hook_add(unicorn.UC_HOOK_CODE, lambda uc, *_: uc.emu_stop(), begin=_RETURN_PAGE, end=0xFFFF_FFFF)
        uc.mmio_map(0xE000_0000, 0x10_0000, self._read, 0xE000_0000, self._write, 0xE000_0000)
        uc.hook_add(unicorn.UC_HOOK_BLOCK, self._block)
        uc.hook_add(unicorn.UC_HOOK_MEM_UNMAPPED, self._unmapped)
        uc.hook_add(unicorn.UC_HOOK_INSN_INVALID, self._undefined)
        uc.hook_add(unicorn.UC_HOOK_INTR, self._trapped)

    def map_peripherals(self, address: int, size: int) -> None:
        """Sends accesses to these addresses to the bus."""
        self.uc.mmio_map(address, size, self._read, address, self._write, address)

    def load(self, path: str) -> int:
        """Writes an ELF file's contents to memory; the address of its vector table."""
        with open(path, "rb") as file:
            elf = ELFFile(file)
            for segment in elf.iter_segments():
                if segment["p_type"] == "PT_LOAD" and segment["p_filesz"]:
                    self.uc.mem_write(segment["p_paddr"], segment.data())
            text = elf.get_section_by_name(".text")
            self._watch_sleep(text["sh_addr"], text.data())
            symbols = elf.get_section_by_name(".symtab").iter_symbols()
            self.symbols = {symbol.name: symbol["st_value"] for symbol in symbols}
            return elf.get_section_by_name(".vector_table")["sh_addr"]

    def _watch_sleep(self, base: int, code: bytes) -> None:
        """The image's instructions stay as they are: the core stops before each that sleeps."""
        for offset in range(0, len(code) - 1, 2):
            if code[offset:offset + 2] in (_WFE, _WFI):
                self.uc.hook_add(unicorn.UC_HOOK_CODE, self._sleep, begin=base + offset, end=base + offset)

    def begin(self, vector_table: int) -> None:
        """Starts at a vector table as the hardware does after a reset, or as a bootloader does."""
        stack, entry = struct.unpack("<II", self.uc.mem_read(vector_table, 8))
        self.uc.reg_write(arm.UC_ARM_REG_SP, stack)
        self.pc = entry & ~1
        self._asleep = self._woken = False

    def reset(self) -> None:
        """The registers as after a reset; `begin` sets those that a start gives."""
        self.stopped, self._asleep, self._woken = None, False, False
        for register in (arm.UC_ARM_REG_PRIMASK, arm.UC_ARM_REG_BASEPRI, arm.UC_ARM_REG_FAULTMASK,
                         arm.UC_ARM_REG_CONTROL):
            self.uc.reg_write(register, 0)

    # What Unicorn calls.

    def _read(self, _uc: unicorn.Uc, offset: int, size: int, base: int) -> int:
        self.schedule.now += ACCESS_NS
        return self.bus.read(base + offset, size)

    def _write(self, _uc: unicorn.Uc, offset: int, size: int, value: int, base: int) -> None:
        self.schedule.now += ACCESS_NS
        self.bus.write(base + offset, size, value)

    def _block(self, uc: unicorn.Uc, _address: int, size: int, _user: object) -> None:
        schedule = self.schedule
        schedule.now += int(size * self.ns_per_byte) + 1
        if schedule.now >= schedule.next_due or self.system.pending and self._next() is not None:
            uc.emu_stop()

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
        return bool(self.uc.reg_read(arm.UC_ARM_REG_FAULTMASK) & 1)

    def _next(self) -> int | None:
        uc = self.uc
        if self.faults_masked:
            return None
        return self.system.next_exception(uc.reg_read(arm.UC_ARM_REG_PRIMASK), uc.reg_read(arm.UC_ARM_REG_BASEPRI))

    def run(self, until_ns: int) -> None:
        """Runs until that time, or until something stops the core: `stopped` says what."""
        schedule, uc = self.schedule, self.uc
        while schedule.now < until_ns and self.stopped is None:
            schedule.run_due()
            exception = self._next() if self.system.pending else None
            if exception is not None:
                self._wake()
                self._enter(exception)
            elif self._asleep:
                if self._woken or self.system.wakes():
                    self._wake()
                else:
                    slept = max(0, min(schedule.next_due, until_ns) - schedule.now)
                    self.idle_ns += slept
                    schedule.now += slept
                    continue
            self._fault: tuple[int, int | None] | None = None
            try:
                uc.emu_start(self.pc | 1, 0)
            except unicorn.UcError as error:
                if self._fault is None:
                    self.stopped = f"{error} at {uc.reg_read(arm.UC_ARM_REG_PC):#x}"
                    return
            self.pc = uc.reg_read(arm.UC_ARM_REG_PC)
            if self._fault is not None:
                self._take_fault(*self._fault)
            elif self.pc >= _RETURN_PAGE:
                self._leave()

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
        uc, system = self.uc, self.system
        floats = system.saves_floats
        sp, flags = uc.reg_read(arm.UC_ARM_REG_SP), uc.reg_read(arm.UC_ARM_REG_XPSR)
        frame_bytes = 104 if floats else 32
        padded = sp - frame_bytes & 4
        frame = sp - frame_bytes & ~7
        words = [uc.reg_read(register) for register in _PLAIN]
        number = system.active[-1][0] if system.active else 0
        saved = struct.pack("<8I", *words, self.pc, flags & 0xFF00_0000 | (0x200 if padded else 0) | 1 << 24 | number)
        if floats:
            doubles = [uc.reg_read(register) for register in _FLOATS]
            saved += struct.pack("<8Q2I", *doubles, uc.reg_read(arm.UC_ARM_REG_FPSCR), 0)
        uc.mem_write(frame, saved)
        uc.reg_write(arm.UC_ARM_REG_SP, frame)
        uc.reg_write(arm.UC_ARM_REG_LR, _EXC_RETURN_FLOATS if floats else _EXC_RETURN_PLAIN)
        self.deepest_stack = min(self.deepest_stack, frame)
        system.enter(exception)
        self.taken[exception - FIRST_INTERRUPT] += 1
        vector = struct.unpack("<I", uc.mem_read(system.vector_table + 4 * exception, 4))[0]
        self.pc = vector & ~1

    def _leave(self) -> None:
        uc, system = self.uc, self.system
        frame = uc.reg_read(arm.UC_ARM_REG_SP)
        floats = not self.pc & 0x10
        saved = uc.mem_read(frame, 104 if floats else 32)
        *words, pc, flags = struct.unpack_from("<8I", saved)
        for register, value in zip(_PLAIN, words):
            uc.reg_write(register, value)
        if floats:
            *doubles, status = struct.unpack_from("<8QI", saved, 32)
            for register, value in zip(_FLOATS, doubles):
                uc.reg_write(register, value)
            uc.reg_write(arm.UC_ARM_REG_FPSCR, status)
        uc.reg_write(arm.UC_ARM_REG_SP, frame + len(saved) + (4 if flags & 0x200 else 0))
        uc.reg_write(arm.UC_ARM_REG_XPSR, flags & 0xF900_0000)
        self.pc = pc & ~1
        self._woken = True
        system.leave()
