(** * The desired frame, its angular velocity and angular acceleration

    Sections III and V of the paper: R_d = [upsilon, rho x upsilon, rho] from the
    acceleration command u (m/s^2) and the heading nu (a horizontal unit
    vector), both moving; omega_d, rad/s, and omega_d', rad/s^2, in its own axes.
    controller-core/src/attitude_reference.rs. [Lemma1] bounds both. *)

From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From SaturatedHybrid Require Import Space Direction.
Open Scope R_scope.

(** The heading turned by a quarter. *)
Definition sideways (nu : space) : space := {| x := - y nu; y := x nu; z := 0 |}.

(** omega_d of the paper, for rho' and upsilon'. *)
Definition turning (rho rho_1 upsilon upsilon_1 : space) : space :=
  {| x := dot upsilon (cross rho rho_1); y := dot upsilon rho_1; z := - dot upsilon (cross rho upsilon_1) |}.
(** omega_d' is this of omega_d, and what [turning] makes of rho'' and upsilon''. *)
Definition products (w : space) : space := {| x := y w * z w; y := - (x w * z w); z := - (x w * y w) |}.

(** ** Of any unit vectors at a right angle *)

Section Frame.

Variables (rho rho_1 upsilon upsilon_1 : space).
Hypothesis rho_unit : square rho = 1.
Hypothesis upsilon_unit : square upsilon = 1.
Hypothesis right_angle : dot rho upsilon = 0.
Hypothesis rho_stays_unit : dot rho rho_1 = 0.
Hypothesis upsilon_stays_unit : dot upsilon upsilon_1 = 0.
Hypothesis angle_stays_right : dot rho upsilon_1 = - dot upsilon rho_1.

Let w := turning rho rho_1 upsilon upsilon_1.

Lemma dot_symmetric : forall a b, dot a b = dot b a.
Proof. intros. components. ring. Qed.

(** The components of a vector in the frame. *)
Lemma frame_expansion : forall v,
  v = add (add (scaled (dot rho v) rho) (scaled (dot upsilon v) upsilon))
          (scaled (dot (cross rho upsilon) v) (cross rho upsilon)).
Proof.
  intros v. pose proof (fun e => in_a_frame rho upsilon v e rho_unit upsilon_unit right_angle) as H.
  apply same; cbn [x y z add scaled].
  - specialize (H {| x := 1; y := 0; z := 0 |}). generalize dependent (cross rho upsilon). intros c H.
    generalize dependent (dot rho v). generalize dependent (dot upsilon v). generalize dependent (dot c v).
    intros p q r H. components. lra.
  - specialize (H {| x := 0; y := 1; z := 0 |}). generalize dependent (cross rho upsilon). intros c H.
    generalize dependent (dot rho v). generalize dependent (dot upsilon v). generalize dependent (dot c v).
    intros p q r H. components. lra.
  - specialize (H {| x := 0; y := 0; z := 1 |}). generalize dependent (cross rho upsilon). intros c H.
    generalize dependent (dot rho v). generalize dependent (dot upsilon v). generalize dependent (dot c v).
    intros p q r H. components. lra.
Qed.

Lemma side_rho : dot (cross rho upsilon) rho_1 = - x w.
Proof. unfold w, turning. cbn [x]. components. ring. Qed.

Lemma side_upsilon : dot (cross rho upsilon) upsilon_1 = z w.
Proof. unfold w, turning. cbn [z]. components. ring. Qed.

(** R_d' = R_d [omega_d]x, column by column. *)
Theorem frame_turns :
  rho_1 = sub (scaled (y w) upsilon) (scaled (x w) (cross rho upsilon)) /\
  upsilon_1 = sub (scaled (z w) (cross rho upsilon)) (scaled (y w) rho) /\
  add (cross rho_1 upsilon) (cross rho upsilon_1) = sub (scaled (x w) rho) (scaled (z w) upsilon).
Proof.
  assert (H1 : rho_1 = sub (scaled (y w) upsilon) (scaled (x w) (cross rho upsilon))).
  { rewrite (frame_expansion rho_1) at 1. rewrite side_rho, rho_stays_unit. change (dot upsilon rho_1) with (y w).
    generalize (x w) (y w) (cross rho upsilon). intros p q c. apply same; components; ring. }
  assert (H2 : upsilon_1 = sub (scaled (z w) (cross rho upsilon)) (scaled (y w) rho)).
  { rewrite (frame_expansion upsilon_1) at 1. rewrite side_upsilon, upsilon_stays_unit, angle_stays_right.
    change (dot upsilon rho_1) with (y w).
    generalize (z w) (y w) (cross rho upsilon). intros p q c. apply same; components; ring. }
  split; [exact H1 | split; [exact H2|]].
  rewrite H1, H2. generalize (x w) (y w) (z w). intros p q r.
  assert (Ha : cross (cross rho upsilon) upsilon = scaled (-1) rho).
  { transitivity (sub (scaled (dot rho upsilon) upsilon) (scaled (square upsilon) rho)).
    - apply same; components; ring.
    - rewrite right_angle, upsilon_unit. apply same; components; ring. }
  assert (Hb : cross rho (cross rho upsilon) = scaled (-1) upsilon).
  { transitivity (sub (scaled (dot rho upsilon) rho) (scaled (square rho) upsilon)).
    - apply same; components; ring.
    - rewrite right_angle, rho_unit. apply same; components; ring. }
  transitivity (sub (scaled r (cross rho (cross rho upsilon))) (scaled p (cross (cross rho upsilon) upsilon))).
  - apply same; components; ring.
  - rewrite Ha, Hb. apply same; components; ring.
Qed.

(** What is left of the derivatives of the products in omega_d. *)
Lemma turning_products :
  dot upsilon_1 (cross rho rho_1) = y w * z w /\
  dot upsilon_1 rho_1 = - (x w * z w) /\
  dot upsilon (cross rho_1 upsilon_1) = x w * y w.
Proof.
  destruct frame_turns as (H1 & H2 & _). revert H1 H2. generalize (x w) (y w) (z w). intros p q r H1 H2.
  assert (Hc : square (cross rho upsilon) = 1).
  { replace (square (cross rho upsilon)) with (square rho * square upsilon - dot rho upsilon * dot rho upsilon)
      by (components; ring). rewrite rho_unit, upsilon_unit, right_angle. ring. }
  rewrite H1, H2. repeat split.
  - transitivity (r * q * square (cross rho upsilon)); [components; ring | rewrite Hc; ring].
  - transitivity (- (p * r) * square (cross rho upsilon) - q * q * dot rho upsilon); [components; ring|].
    rewrite Hc, right_angle. ring.
  - transitivity (p * q * square (cross rho upsilon)); [components; ring | rewrite Hc; ring].
Qed.

(** |omega_d|^2 <= |rho'|^2 + |upsilon'|^2, and the products are at most
    |rho'| |upsilon'|. *)
Lemma turning_squares :
  x w * x w + y w * y w = square rho_1 /\ y w * y w + z w * z w = square upsilon_1.
Proof.
  pose proof (in_a_frame rho upsilon rho_1 rho_1 rho_unit upsilon_unit right_angle) as H1.
  pose proof (in_a_frame rho upsilon upsilon_1 upsilon_1 rho_unit upsilon_unit right_angle) as H2.
  rewrite side_rho, rho_stays_unit in H1. rewrite side_upsilon, upsilon_stays_unit, angle_stays_right in H2.
  change (dot upsilon rho_1) with (y w) in H1, H2. unfold square. rewrite H1, H2. split; ring.
Qed.

Lemma turning_of_seconds : forall rho_2 upsilon_2,
  square (turning rho rho_2 upsilon upsilon_2) <= square rho_2 + square upsilon_2.
Proof.
  intros r_2 u_2.
  pose proof (in_a_frame rho upsilon r_2 r_2 rho_unit upsilon_unit right_angle) as H1.
  pose proof (in_a_frame rho upsilon u_2 u_2 rho_unit upsilon_unit right_angle) as H2.
  pose proof (squared (dot rho r_2)). pose proof (squared (dot rho u_2)). pose proof (squared (dot upsilon u_2)).
  replace (square (turning rho r_2 upsilon u_2))
    with (dot (cross rho upsilon) r_2 * dot (cross rho upsilon) r_2 + dot upsilon r_2 * dot upsilon r_2
          + dot (cross rho upsilon) u_2 * dot (cross rho upsilon) u_2)
    by (unfold turning; components; ring).
  unfold square. lra.
Qed.

End Frame.

(** ** Of a command and a heading that move *)

Section Motion.

Variables (u u_1 nu nu_1 : R -> space) (t : R) (u_2 nu_2 : space).
Hypothesis u_moves : moves u t (u_1 t).
Hypothesis u_1_moves : moves u_1 t u_2.
Hypothesis nu_moves : moves nu t (nu_1 t).
Hypothesis nu_1_moves : moves nu_1 t nu_2.
Hypothesis upwards : 0 < z (u t).
Hypothesis heading : x (nu t) * x (nu t) + y (nu t) * y (nu t) = 1.

Definition rho (s : R) : space := direction (u s).
Definition rho_1 (s : R) : space := direction_rate (u s) (u_1 s).
(** The heading projected on the plane across rho, not yet of unit length. *)
Definition varpi (s : R) : space :=
  {| x := z (rho s) * x (nu s); y := z (rho s) * y (nu s);
     z := - (x (rho s) * x (nu s) + y (rho s) * y (nu s)) |}.
Definition varpi_1 (s : R) : space :=
  add (cross (sideways (nu_1 s)) (rho s)) (cross (sideways (nu s)) (rho_1 s)).
Definition upsilon (s : R) : space := direction (varpi s).
Definition upsilon_1 (s : R) : space := direction_rate (varpi s) (varpi_1 s).
Definition omega (s : R) : space := turning (rho s) (rho_1 s) (upsilon s) (upsilon_1 s).

Definition rho_2 : space := direction_second (u t) (u_1 t) u_2.
Definition varpi_2 : space :=
  add (add (cross (sideways nu_2) (rho t)) (cross (sideways (nu_1 t)) (rho_1 t)))
      (add (cross (sideways (nu_1 t)) (rho_1 t)) (cross (sideways (nu t)) rho_2)).
Definition upsilon_2 : space := direction_second (varpi t) (varpi_1 t) varpi_2.
Definition omega_1 : space := add (products (omega t)) (turning (rho t) rho_2 (upsilon t) upsilon_2).

Lemma varpi_is_a_product : forall s, varpi s = cross (sideways (nu s)) (rho s).
Proof. intros s. unfold varpi, sideways. apply same; components; ring. Qed.

Lemma u_length : 0 < length (u t).
Proof.
  apply sqrt_lt_R0. pose proof (squared (x (u t))). pose proof (squared (y (u t))).
  assert (0 < z (u t) * z (u t)) by (now apply Rmult_lt_0_compat). components. lra.
Qed.

(** |varpi| is at least the cosine of the tilt. *)
Lemma varpi_length : z (u t) / length (u t) <= length (varpi t).
Proof.
  pose proof u_length as Hn.
  assert (E : z (u t) / length (u t) = z (rho t)) by (unfold rho, direction; cbn; field; lra).
  rewrite E. apply below_by_squares; [apply length_nonneg|]. rewrite length_squared. unfold varpi.
  pose proof (squared (x (rho t) * x (nu t) + y (rho t) * y (nu t))).
  replace (z (rho t) * z (rho t)) with (z (rho t) * z (rho t) * (x (nu t) * x (nu t) + y (nu t) * y (nu t)))
    by (rewrite heading; ring). components. lra.
Qed.

Lemma varpi_positive : 0 < length (varpi t).
Proof. eapply Rlt_le_trans; [|apply varpi_length]. apply Rdiv_lt_0_compat; [exact upwards | apply u_length]. Qed.

Lemma moves_sideways : forall v d, moves v t d -> moves (fun s => sideways (v s)) t (sideways d).
Proof.
  intros v d (Hx & Hy & _). exact (conj (derive_opposite _ _ _ Hy) (conj Hx (derive_constant 0 t))).
Qed.

Lemma rho_moves : moves rho t (rho_1 t).
Proof. apply direction_moves; [apply u_length | exact u_moves]. Qed.

Lemma rho_1_moves : moves rho_1 t rho_2.
Proof. apply (direction_rate_moves u u_1 t u_2); [apply u_length | exact u_moves | exact u_1_moves]. Qed.

Lemma varpi_moves : moves varpi t (varpi_1 t).
Proof.
  pose proof (moves_cross _ _ _ _ _ (moves_sideways _ _ nu_moves) rho_moves) as (Hx & Hy & Hz).
  assert (Hsame : forall s, cross (sideways (nu s)) (rho s) = varpi s) by (intros s; now rewrite varpi_is_a_product).
  split; [|split]; eapply is_derive_ext; try eassumption; intros s; cbv beta; now rewrite Hsame.
Qed.

Lemma varpi_1_moves : moves varpi_1 t varpi_2.
Proof.
  exact (moves_add _ _ _ _ _ (moves_cross _ _ _ _ _ (moves_sideways _ _ nu_1_moves) rho_moves)
    (moves_cross _ _ _ _ _ (moves_sideways _ _ nu_moves) rho_1_moves)).
Qed.

Lemma upsilon_moves : moves upsilon t (upsilon_1 t).
Proof. apply direction_moves; [apply varpi_positive | exact varpi_moves]. Qed.

Lemma upsilon_1_moves : moves upsilon_1 t upsilon_2.
Proof. apply (direction_rate_moves varpi varpi_1 t varpi_2); [apply varpi_positive | exact varpi_moves |
  exact varpi_1_moves]. Qed.

(** R_d is a rotation, and stays one. *)
Lemma frame_at_t :
  square (rho t) = 1 /\ square (upsilon t) = 1 /\ dot (rho t) (upsilon t) = 0 /\
  dot (rho t) (rho_1 t) = 0 /\ dot (upsilon t) (upsilon_1 t) = 0 /\
  dot (rho t) (upsilon_1 t) = - dot (upsilon t) (rho_1 t).
Proof.
  pose proof u_length as Hu. pose proof varpi_positive as Hv.
  assert (Hacross : dot (rho t) (upsilon t) = 0).
  { unfold upsilon, direction. rewrite varpi_is_a_product.
    generalize (rho t) (sideways (nu t)) (length (cross (sideways (nu t)) (rho t))). intros r n l. components. ring. }
  split; [now apply direction_unit|]. split; [now apply direction_unit|]. split; [exact Hacross|].
  split; [now apply rate_orthogonal|]. split; [now apply rate_orthogonal|].
  unfold upsilon_1, direction_rate, across. fold (upsilon t).
  assert (Hrate : dot (rho t) (varpi_1 t) = - dot (varpi t) (rho_1 t)).
  { rewrite varpi_is_a_product. unfold varpi_1. components. ring. }
  replace (dot (rho t) (scaled (/ length (varpi t)) (sub (varpi_1 t) (scaled (dot (upsilon t) (varpi_1 t)) (upsilon
    t)))))
    with (/ length (varpi t) * (dot (rho t) (varpi_1 t) - dot (upsilon t) (varpi_1 t) * dot (rho t) (upsilon t)))
    by (generalize (dot (upsilon t) (varpi_1 t)); intros m; components; ring).
  rewrite Hrate, Hacross. unfold upsilon, direction. components. ring.
Qed.

(** omega_d turns the frame of the moving command and heading: R_d' = R_d [omega_d]x. *)
Theorem columns_move :
  moves rho t (sub (scaled (y (omega t)) (upsilon t)) (scaled (x (omega t)) (cross (rho t) (upsilon t)))) /\
  moves upsilon t (sub (scaled (z (omega t)) (cross (rho t) (upsilon t))) (scaled (y (omega t)) (rho t))) /\
  moves (fun s => cross (rho s) (upsilon s)) t
    (sub (scaled (x (omega t)) (rho t)) (scaled (z (omega t)) (upsilon t))).
Proof.
  destruct frame_at_t as (F1 & F2 & F3 & F4 & F5 & F6).
  destruct (frame_turns _ _ _ _ F1 F2 F3 F4 F5 F6) as (H1 & H2 & H3). fold (omega t) in H1, H2, H3.
  split; [|split].
  - rewrite <- H1. exact rho_moves.
  - rewrite <- H2. exact upsilon_moves.
  - rewrite <- H3. exact (moves_cross _ _ _ _ _ rho_moves upsilon_moves).
Qed.

(** omega_d' is the derivative of omega_d: the paper's formula. *)
Theorem omega_moves : moves omega t omega_1.
Proof.
  destruct frame_at_t as (F1 & F2 & F3 & F4 & F5 & F6).
  destruct (turning_products _ _ _ _ F1 F2 F3 F4 F5 F6) as (P1 & P2 & P3).
  pose proof rho_moves as Hr. pose proof upsilon_moves as Hu. pose proof rho_1_moves as Hr1.
  pose proof upsilon_1_moves as Hu1.
  fold (omega t) in P1, P2, P3. unfold omega_1, omega, turning, products.
  split; [|split]; cbn [x y z add].
  - eapply derive_as; [exact (moves_dot _ _ _ _ _ Hu (moves_cross _ _ _ _ _ Hr Hr1))|].
    fold (turning (rho t) (rho_1 t) (upsilon t) (upsilon_1 t)). fold (omega t). cbn beta.
    change (dot (upsilon t) (cross (rho t) (rho_1 t))) with (x (omega t)). rewrite P1.
    unfold omega, turning. cbn [x y z].
    generalize (rho_1 t) (upsilon t) (rho t) rho_2 (upsilon_1 t). intros a b c d e. components. ring.
  - eapply derive_as; [exact (moves_dot _ _ _ _ _ Hu Hr1)|]. cbn beta. rewrite P2. unfold omega, turning.
  cbn [x y z]. ring.
  - eapply derive_as.
    + exact (derive_opposite _ _ _ (moves_dot _ _ _ _ _ Hu (moves_cross _ _ _ _ _ Hr Hu1))).
    + cbn beta. transitivity (- dot (upsilon t) (cross (rho_1 t) (upsilon_1 t)) + - dot (upsilon t) (cross (rho t)
      upsilon_2)).
      * generalize (rho_1 t) (upsilon t) (rho t) upsilon_2 (upsilon_1 t). intros a b c d e. components. ring.
      * rewrite P3. unfold omega, turning. cbn [x y z]. ring.
Qed.

End Motion.
