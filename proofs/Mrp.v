(** * Modified Rodrigues parameters and quaternions

    Section II and Appendix A of the paper, in exact arithmetic;
    controller-core/src/mrp.rs and controller-core/src/path_lifting.rs. A
    rotation is given by its nine entries, row by row. *)

From Coq Require Import Reals Lra.
Open Scope R_scope.

(** R(q) = I + 2 q_0 [q_1]x + 2 [q_1]x^2 of a quaternion (a, b, c, d). *)
Definition R_11 (a b c d : R) : R := 1 - 2 * (c * c + d * d).
Definition R_12 (a b c d : R) : R := 2 * (b * c - a * d).
Definition R_13 (a b c d : R) : R := 2 * (b * d + a * c).
Definition R_21 (a b c d : R) : R := 2 * (b * c + a * d).
Definition R_22 (a b c d : R) : R := 1 - 2 * (b * b + d * d).
Definition R_23 (a b c d : R) : R := 2 * (c * d - a * b).
Definition R_31 (a b c d : R) : R := 2 * (b * d - a * c).
Definition R_32 (a b c d : R) : R := 2 * (c * d + a * b).
Definition R_33 (a b c d : R) : R := 1 - 2 * (b * b + c * c).

(** R_theta(theta), eq. (1), with its sign put right:
    I + (8 [theta]x^2 + 4 (1 - |theta|^2) [theta]x) / (1 + |theta|^2)^2. *)
Definition square (x y z : R) : R := x * x + y * y + z * z.
Definition below (x y z : R) : R := (1 + square x y z) * (1 + square x y z).
Definition diagonal (x y z u v : R) : R := 1 - 8 * (u * u + v * v) / below x y z.
Definition off (x y z product sine : R) : R :=
  (8 * product + 4 * (1 - square x y z) * sine) / below x y z.

Definition M_11 (x y z : R) : R := diagonal x y z y z.
Definition M_12 (x y z : R) : R := off x y z (x * y) (- z).
Definition M_13 (x y z : R) : R := off x y z (x * z) y.
Definition M_21 (x y z : R) : R := off x y z (x * y) z.
Definition M_22 (x y z : R) : R := diagonal x y z x z.
Definition M_23 (x y z : R) : R := off x y z (y * z) (- x).
Definition M_31 (x y z : R) : R := off x y z (x * z) (- y).
Definition M_32 (x y z : R) : R := off x y z (y * z) x.
Definition M_33 (x y z : R) : R := diagonal x y z x y.

Ltac entries := unfold M_11, M_12, M_13, M_21, M_22, M_23, M_31, M_32, M_33,
  R_11, R_12, R_13, R_21, R_22, R_23, R_31, R_32, R_33, diagonal, off.

Lemma below_positive : forall x y z, 0 < 1 + square x y z.
Proof. intros. unfold square. nra. Qed.

Section Unit.

Variables (a b c d : R).
Hypothesis unit : a * a + b * b + c * c + d * d = 1.

(** R(q) = R(-q): the two lifts of one rotation. *)
Theorem both_lifts :
  R_11 a b c d = R_11 (- a) (- b) (- c) (- d) /\ R_12 a b c d = R_12 (- a) (- b) (- c) (- d) /\
  R_13 a b c d = R_13 (- a) (- b) (- c) (- d) /\ R_21 a b c d = R_21 (- a) (- b) (- c) (- d) /\
  R_22 a b c d = R_22 (- a) (- b) (- c) (- d) /\ R_23 a b c d = R_23 (- a) (- b) (- c) (- d) /\
  R_31 a b c d = R_31 (- a) (- b) (- c) (- d) /\ R_32 a b c d = R_32 (- a) (- b) (- c) (- d) /\
  R_33 a b c d = R_33 (- a) (- b) (- c) (- d).
Proof. entries. repeat split; ring. Qed.

Hypothesis not_opposite : 0 < 1 + a.

(** phi(q) = q_1 / (1 + q_0). *)
Definition phi (component : R) : R := component / (1 + a).

Lemma phi_square : square (phi b) (phi c) (phi d) = (1 - a) / (1 + a).
Proof.
  unfold square, phi.
  transitivity ((b * b + c * c + d * d) / ((1 + a) * (1 + a))); [field; lra|].
  replace (b * b + c * c + d * d) with ((1 - a) * (1 + a)) by lra. field. lra.
Qed.

(** |phi(q)| <= 1 + delta is the same as q_0 >= (1 - (1 + delta)^2) / (1 + (1 + delta)^2):
    the switch compares without dividing. *)
Theorem switch_without_division : forall delta, 0 < delta ->
  square (phi b) (phi c) (phi d) <= (1 + delta) * (1 + delta) <->
  (1 - (1 + delta) * (1 + delta)) / (1 + (1 + delta) * (1 + delta)) <= a.
Proof.
  intros delta Hdelta. rewrite phi_square.
  set (k := (1 + delta) * (1 + delta)). assert (Hk : 0 < k) by (unfold k; nra).
  split; intros H.
  - apply Rmult_le_reg_r with (1 + k); [lra|].
    replace ((1 - k) / (1 + k) * (1 + k)) with (1 - k) by (field; lra).
    apply Rmult_le_compat_r with (r := 1 + a) in H; [|lra].
    replace ((1 - a) / (1 + a) * (1 + a)) with (1 - a) in H by (field; lra). nra.
  - apply Rmult_le_reg_r with (1 + a); [lra|].
    replace ((1 - a) / (1 + a) * (1 + a)) with (1 - a) by (field; lra).
    apply Rmult_le_compat_r with (r := 1 + k) in H; [|lra].
    replace ((1 - k) / (1 + k) * (1 + k)) with (1 - k) in H by (field; lra). nra.
Qed.

(** R_theta(phi(q)) = R(q), with the plus sign; the paper prints a minus,
    which gives the transpose. *)
Lemma scale_of_phi : 1 + square (phi b) (phi c) (phi d) = 2 / (1 + a).
Proof. rewrite phi_square. field. lra. Qed.

Lemma rest_of_phi : 1 - square (phi b) (phi c) (phi d) = 2 * a / (1 + a).
Proof. rewrite phi_square. field. lra. Qed.

Lemma diagonal_of_phi : forall u v,
  diagonal (phi b) (phi c) (phi d) (phi u) (phi v) = 1 - 2 * (u * u + v * v).
Proof.
  intros. unfold diagonal, below. rewrite scale_of_phi. unfold phi. field. lra.
Qed.

Lemma off_of_phi : forall u v s,
  off (phi b) (phi c) (phi d) (phi u * phi v) (phi s) = 2 * (u * v + a * s).
Proof.
  intros. unfold off, below. rewrite scale_of_phi, rest_of_phi. unfold phi. field. lra.
Qed.

Lemma phi_opp : forall u, - phi u = phi (- u).
Proof. intros. unfold phi. field. lra. Qed.

Theorem rotation_of_phi :
  M_11 (phi b) (phi c) (phi d) = R_11 a b c d /\ M_12 (phi b) (phi c) (phi d) = R_12 a b c d /\
  M_13 (phi b) (phi c) (phi d) = R_13 a b c d /\ M_21 (phi b) (phi c) (phi d) = R_21 a b c d /\
  M_22 (phi b) (phi c) (phi d) = R_22 a b c d /\ M_23 (phi b) (phi c) (phi d) = R_23 a b c d /\
  M_31 (phi b) (phi c) (phi d) = R_31 a b c d /\ M_32 (phi b) (phi c) (phi d) = R_32 a b c d /\
  M_33 (phi b) (phi c) (phi d) = R_33 a b c d.
Proof.
  unfold M_11, M_12, M_13, M_21, M_22, M_23, M_31, M_32, M_33.
  rewrite !phi_opp, !diagonal_of_phi, !off_of_phi. entries. repeat split; ring.
Qed.

End Unit.

(** The shadow -theta / |theta|^2 is the same rotation. *)
Section Shadow.

Variables (x y z : R).
Hypothesis not_zero : 0 < square x y z.

Definition shadow (component : R) : R := - component / square x y z.

Lemma shadow_square : square (shadow x) (shadow y) (shadow z) = / square x y z.
Proof.
  unfold shadow. set (s := square x y z) in *.
  transitivity (square x y z / (s * s)); [unfold square; field; lra|].
  fold s. field. lra.
Qed.

Lemma diagonal_of_shadow : forall u v,
  diagonal (shadow x) (shadow y) (shadow z) (shadow u) (shadow v) = diagonal x y z u v.
Proof.
  intros u v. unfold diagonal, below. rewrite shadow_square. unfold shadow.
  set (s := square x y z) in *. field. lra.
Qed.

Lemma off_of_shadow : forall u v s,
  off (shadow x) (shadow y) (shadow z) (shadow u * shadow v) (shadow s) = off x y z (u * v) s.
Proof.
  intros u v t. unfold off, below. rewrite shadow_square. unfold shadow.
  set (s := square x y z) in *. field. lra.
Qed.

Lemma shadow_opp : forall u, - shadow u = shadow (- u).
Proof. intros. unfold shadow. field. lra. Qed.

Theorem rotation_of_shadow :
  M_11 (shadow x) (shadow y) (shadow z) = M_11 x y z /\ M_12 (shadow x) (shadow y) (shadow z) = M_12 x y z /\
  M_13 (shadow x) (shadow y) (shadow z) = M_13 x y z /\ M_21 (shadow x) (shadow y) (shadow z) = M_21 x y z /\
  M_22 (shadow x) (shadow y) (shadow z) = M_22 x y z /\ M_23 (shadow x) (shadow y) (shadow z) = M_23 x y z /\
  M_31 (shadow x) (shadow y) (shadow z) = M_31 x y z /\ M_32 (shadow x) (shadow y) (shadow z) = M_32 x y z /\
  M_33 (shadow x) (shadow y) (shadow z) = M_33 x y z.
Proof.
  unfold M_11, M_12, M_13, M_21, M_22, M_23, M_31, M_32, M_33.
  rewrite !shadow_opp, !diagonal_of_shadow, !off_of_shadow. repeat split; reflexivity.
Qed.

End Shadow.

(** After the switch the parameters are inside: at |phi(q)| >= 1 + delta the
    other lift has |phi(-q)| <= 1 / (1 + delta). *)
Theorem switch_goes_inside : forall a delta, 0 < delta -> -1 < a < 1 ->
  a <= (1 - (1 + delta) * (1 + delta)) / (1 + (1 + delta) * (1 + delta)) ->
  (1 - (- a)) / (1 + (- a)) <= / ((1 + delta) * (1 + delta)).
Proof.
  intros a delta Hd Ha H. set (k := (1 + delta) * (1 + delta)) in *.
  assert (Hk : 0 < k) by (unfold k; nra).
  apply Rmult_le_compat_r with (r := 1 + k) in H; [|lra].
  replace ((1 - k) / (1 + k) * (1 + k)) with (1 - k) in H by (field; lra).
  apply Rmult_le_reg_r with ((1 - a) * k); [nra|].
  replace ((1 - - a) / (1 + - a) * ((1 - a) * k)) with ((1 + a) * k) by (field; lra).
  replace (/ k * ((1 - a) * k)) with (1 - a) by (field; lra). nra.
Qed.
